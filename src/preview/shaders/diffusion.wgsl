// The diffusion pass: spreads the diffuse light of skin and wax over the surface around it, by the normalised diffusion
// profile (Christensen and Burley 2015, "Approximate Reflectance Profiles for Efficient Subsurface Scattering"), and
// applies the base colour of each pixel. Samples lie in the tangent plane of the pixel's point; they are weighted by
// the distance of what the picture shows there (Golubev 2018, "Efficient Screen-Space Subsurface Scattering Using
// Burley's Normalized Diffusion in Real-Time").

@group(1) @binding(0) var gbuffer: texture_2d<u32>;
@group(1) @binding(1) var ids: texture_2d<u32>;
// Diffuse light, specular light, normal, depth.
@group(2) @binding(0) var shaded: texture_2d<u32>;

// Writes scene-linear radiance instead of display values.
override LINEAR: bool = false;

const SAMPLES: u32 = 24u;
// Quantiles of the profile's radius, in shape parameters: (i + 0.5) / 24.
const RADII = array<f32, 24>(
    0.0423, 0.1305, 0.2241, 0.3237, 0.4299, 0.5437, 0.6659, 0.7976, 0.9403, 1.0955, 1.2651, 1.4517,
    1.6581, 1.8883, 2.1472, 2.4412, 2.7792, 3.1739, 3.6437, 4.2184, 4.9495, 5.9412, 7.4616, 10.7513,
);

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return fullscreen_corner(index);
}

// Returns the profile, times 8 pi, at a distance.
fn profile(distance: f32, shape: vec3f) -> vec3f {
    let x = exp(-distance / (3.0 * shape));
    return (x * x * x + x) / (shape * distance);
}

// Returns the shape parameters of the profile at a pixel of this id, metres; 0 where nothing scatters.
fn shape_of(id: u32) -> vec3f {
    return select(surfaces[max(id & ID_INDEX_MASK, 1u) - 1u].diffusion_m, vec3f(0.0), id == 0u);
}

fn position_at(at: vec2f, depth: f32) -> vec3f {
    return frame.eye + pixel_ray(at) * (frame.near_m / max(depth, 1e-9));
}

// Returns the diffuse light around a pixel.
fn diffused(at: vec2f, own: vec3f, packed_normal: u32, depth: f32, shape: vec3f) -> vec3f {
    let pixel_m = 2.0 * frame.pixel_angle * frame.near_m / max(depth, 1e-9);
    let widest = max(shape.x, max(shape.y, shape.z));
    let position = position_at(at, depth);
    let normal = unpack_direction(packed_normal);
    let side = select(vec3f(1.0, 0.0, 0.0), vec3f(0.0, 1.0, 0.0), abs(normal.y) < 0.9);
    let tangent = normalize(cross(normal, side));
    let bitangent = cross(normal, tangent);
    // Interleaved gradient noise (Jimenez 2014) turns the spiral of samples
    var turn = 6.2831853 * fract(52.9829189 * fract(dot(at, vec2f(0.06711056, 0.00583715))));
    var sum = own * 1e-4;
    var total = vec3f(1e-4);
    for (var i = 0u; i < SAMPLES; i++) {
        let radius = RADII[i] * widest;
        let target_position = position + radius * (cos(turn) * tangent + sin(turn) * bitangent);
        turn += 2.3999632;
        let clip = frame.clip_from_world * vec4f(target_position, 1.0);
        let uv = clip.xy / clip.w * vec2f(0.5, -0.5) + 0.5;
        let pixel = vec2i(floor(clamp(uv, vec2f(0.0), vec2f(0.9999)) * frame.size));
        let id = textureLoad(ids, pixel, 0).xy;
        // What the pixel shows may lie before or behind the plane, by more than the width of a pixel
        let miss = distance(position_at(vec2f(pixel) + 0.5, bitcast<f32>(id.y)), target_position);
        let off_plane = max(miss - 1.5 * pixel_m, 0.0);
        let reached = sqrt(radius * radius + off_plane * off_plane);
        var weight = profile(reached, shape) / profile(radius, vec3f(widest)).x;
        weight *= select(0.0, 1.0, shape_of(id.x).x > 0.0);
        sum += weight * unpack_radiance(textureLoad(shaded, pixel, 0).x);
        total += weight;
    }
    return sum / total;
}

@fragment
fn fragment(@builtin(position) at: vec4f) -> @location(0) vec4f {
    let pixel = vec2i(at.xy);
    let id = textureLoad(ids, pixel, 0).xy;
    let texel = textureLoad(shaded, pixel, 0);
    let shape = shape_of(id.x);
    var diffuse = unpack_radiance(texel.x);
    if shape.x > 0.0 {
        diffuse = diffused(at.xy, diffuse, texel.z, bitcast<f32>(id.y), shape);
    }
    let base = select(unpack_color(textureLoad(gbuffer, pixel, 0).y), vec3f(0.0), id.x == 0u);
    let radiance = base * diffuse + unpack_radiance(texel.y);
    if LINEAR {
        return vec4f(radiance, 1.0);
    }
    return encode_display(radiance, at.xy);
}
