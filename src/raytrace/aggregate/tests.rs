use super::*;
use crate::math::warp;
use crate::raytrace::geometry::MeshGeometry;
use crate::raytrace::simd::Scalar;
use crate::scene::{Mesh, Shape, tessellate};
use glam::{Quat, Vec2, Vec3, Vec3Swizzles};

impl Hit {
    /// Returns the intersection with a triangle.
    pub(in crate::raytrace) fn triangle(&self) -> TriangleHit {
        let Primitive::Triangle(hit) = self.primitive else { panic!("not a triangle: {self:?}") };
        hit
    }
}

/// Returns deterministic numbers in 0..1.
fn numbers(seed: u32) -> impl FnMut() -> f32 {
    let mut i = 0;
    move || {
        i += 1;
        sobol_burley::sample(i % 65536, i / 65536, seed)
    }
}

fn soup(triangles: usize) -> Mesh {
    let mut next = numbers(3);
    let mut mesh = Mesh::default();
    for i in 0..triangles as u32 {
        let centre = Vec3::new(next(), next(), next()) * 4.0 - 2.0;
        for _ in 0..3 {
            mesh.positions.push(centre + (Vec3::new(next(), next(), next()) - 0.5) * 1.5);
        }
        mesh.triangles.push([3 * i, 3 * i + 1, 3 * i + 2]);
    }
    mesh.with_single_part("soup")
}

fn random_rays(count: u32) -> Vec<Ray> {
    let mut next = numbers(11);
    let ray = |_| {
        let origin = Vec3::new(next(), next(), next()) * 6.0 - 3.0;
        let mut direction = warp::uniform_sphere(Vec2::new(next(), next()));
        // One in ten along an axis, where the slab test multiplies zero by infinity.
        if next() < 0.1 {
            direction = [Vec3::X, Vec3::NEG_Y, Vec3::Z][(next() * 3.0) as usize % 3];
        }
        Ray { origin, direction, t_max: if next() < 0.5 { f32::INFINITY } else { next() * 3.0 } }
    };
    (0..count).map(ray).collect()
}

fn instance(mesh: Mesh, transform: Affine3A, object: u32) -> Instance {
    Instance::new(Arc::new(MeshGeometry::new(Arc::new(mesh))), transform, object, vec![0], None).unwrap()
}

/// Intersects every triangle of every instance, with the same triangle test in the same space.
fn brute_force(instances: &[Instance], ray: &Ray) -> Option<(u32, TriangleHit)> {
    use crate::raytrace::simd::{ShearedRay, TrianglePacket};
    let mut best: Option<(u32, TriangleHit)> = None;
    for (index, instance) in instances.iter().enumerate() {
        let mesh = instance.geometry.mesh();
        let is_merged = mesh.triangles.len() <= MAX_MERGED_MESH;
        let local = if is_merged { *ray } else { instance.to_object(ray) };
        let sheared = ShearedRay::new(local.origin, local.direction);
        for t in 0..mesh.triangles.len() {
            let end = best.as_ref().map_or(ray.t_max, |b| b.1.t);
            let corners = if is_merged { instance.world_corners(t) } else { mesh.corners(t) };
            if let Some(hit) = TrianglePacket::new([(t as u32, corners)]).intersect(&sheared, end) {
                best = Some((index as u32, hit));
            }
        }
    }
    best
}

#[test]
fn the_closest_hit_is_that_of_brute_force() {
    let transform = Affine3A::from_scale_rotation_translation(
        Vec3::new(0.5, 2.0, 1.0),
        Quat::from_rotation_y(0.7),
        Vec3::new(1.0, 0.2, -0.5),
    );
    let cube = tessellate(&Shape::Box { size_m: Vec3::ONE }).unwrap();
    let aggregate = Aggregate::new(vec![
        instance(soup(MAX_MERGED_MESH + 1), transform * Affine3A::from_scale(Vec3::splat(0.9)), 0),
        instance(soup(300), transform, 1),
        instance(cube, Affine3A::from_translation(Vec3::Y), 2),
    ]);
    let mut stack = TraversalStack::default();
    let mut hits = 0;
    for (i, ray) in random_rays(6000).iter().enumerate() {
        let ours = aggregate.intersect(ray, RayFilter::default(), &mut stack);
        let truth = brute_force(aggregate.instances(), ray);
        // Of two triangles at one distance either may be returned; the distance has the same bits.
        assert_eq!(ours.map(|h| h.t), truth.map(|(_, h)| h.t), "ray {i}: {ray:?}");
        assert_eq!(aggregate.occluded(ray, RayFilter::default(), &mut stack), truth.is_some(), "ray {i}: {ray:?}");
        // The scalar kernels return the same bits.
        let scalar =
            Intersect { aggregate: &aggregate, ray, filter: RayFilter::default(), stack: &mut stack }.run::<Scalar>();
        assert_eq!(scalar.map(|h| h.primitive), ours.map(|h| h.primitive), "ray {i}: {ray:?}");
        let scalar =
            Occluded { aggregate: &aggregate, ray, filter: RayFilter::default(), stack: &mut stack }.run::<Scalar>();
        assert_eq!(scalar, truth.is_some(), "ray {i}: {ray:?}");
        hits += usize::from(truth.is_some());
    }
    assert!(hits > 1000, "only {hits} rays hit anything: too few for the test");
}

#[test]
fn of_ten_thousand_spheres_few_are_merged_and_all_are_hit() {
    let sphere = Arc::new(MeshGeometry::new(Arc::new(soup(100))));
    let transform = |i: u32| Affine3A::from_translation(Vec3::new(10.0 * i as f32, 0.0, 0.0));
    let instances: Vec<Instance> =
        (0..10_000).map(|i| Instance::new(sphere.clone(), transform(i), i, vec![0], None).unwrap()).collect();
    let aggregate = Aggregate::new(instances);
    assert!(aggregate.merged.triangles.len() <= MAX_MERGED_TOTAL && aggregate.tlas_entries.len() > 7_000);
    let mut stack = TraversalStack::default();
    for i in (0..10_000).step_by(333) {
        let instance = &aggregate.instances()[i];
        let (low, high) = instance.world_bounds(instance.geometry.blas.bounds().unwrap());
        let count = (0..64).filter(|&k| {
            let offset = Vec3::new(((k % 8) as f32 + 0.5) / 8.0, ((k / 8) as f32 + 0.5) / 8.0, 0.0);
            let origin = low + (high - low) * offset - Vec3::Z;
            let ray = Ray { origin, direction: Vec3::Z, t_max: f32::INFINITY };
            aggregate.intersect(&ray, RayFilter::default(), &mut stack).is_some_and(|hit| hit.instance as usize == i)
        });
        assert!(count.count() > 10, "sphere {i}");
    }
}

#[test]
fn rays_miss_an_empty_studio() {
    let aggregate = Aggregate::new(vec![instance(Mesh::default().with_single_part("none"), Affine3A::IDENTITY, 0)]);
    let ray = Ray { origin: Vec3::ZERO, direction: Vec3::Z, t_max: f32::INFINITY };
    assert!(aggregate.intersect(&ray, RayFilter::default(), &mut TraversalStack::default()).is_none());
}

#[test]
fn rays_that_leave_a_floor_through_the_world_origin_do_not_hit_it_again() {
    // A camera or a meter that lies on a floor: the coordinate along its normal is 0, and once its error bound was,
    // too. Rays hit the floor that they had left, and a white room lost a fourteenth of its light.
    let floor = tessellate(&Shape::Plane { width_m: 4.0, depth_m: 4.0 }).unwrap();
    let aggregate = Aggregate::new(vec![instance(floor, Affine3A::IDENTITY, 0)]);
    let mut stack = TraversalStack::default();
    let mut next = numbers(7);
    for _ in 0..100_000 {
        let origin = Vec3::new(next() * 4.0 - 2.0, 2.0 * next(), next() * 4.0 - 2.0);
        let direction = -warp::cosine_hemisphere(Vec2::new(next(), next())).xzy();
        let ray = Ray { origin, direction, t_max: f32::INFINITY };
        let Some(hit) = aggregate.intersect(&ray, RayFilter::default(), &mut stack) else { continue };
        let surface = aggregate.surface(&hit);
        let away = warp::cosine_hemisphere(Vec2::new(next(), next())).xzy();
        let away = Ray { origin: surface.spawn_origin(away), direction: away, t_max: f32::INFINITY };
        assert!(
            aggregate.intersect(&away, RayFilter::default(), &mut stack).is_none(),
            "left the floor and hit it: {ray:?} {away:?}"
        );
    }
}

#[test]
fn a_million_rays_neither_hit_the_triangle_they_leave_nor_leak_from_a_sphere() {
    // Also far from the camera, where camera-relative coordinates are large.
    let sphere = tessellate(&Shape::Sphere { radius_m: 1.0 }).unwrap();
    for far in [0.0, 1e3, 1e5] {
        let transform = Affine3A::from_translation(Vec3::new(far, -far, far));
        let aggregate = Aggregate::new(vec![instance(sphere.clone(), transform, 0)]);
        let mut stack = TraversalStack::default();
        let mut next = numbers(5);
        for _ in 0..340_000 {
            let origin = Vec3::new(far, -far, far);
            let out = warp::uniform_sphere(Vec2::new(next(), next()));
            let inside = Ray { origin, direction: out, t_max: f32::INFINITY };
            let hit =
                aggregate.intersect(&inside, RayFilter::default(), &mut stack).expect("a ray from the centre leaked");
            let surface = aggregate.surface(&hit);
            // Outwards: a ray from the surface of a convex body does not hit it.
            let local = warp::cosine_hemisphere(Vec2::new(next(), next()));
            let (t, b) = crate::math::orthonormal_basis(surface.geometric_normal);
            let direction = t * local.x + b * local.y + surface.geometric_normal * local.z.max(1e-3);
            let away = Ray { origin: surface.spawn_origin(direction), direction, t_max: f32::INFINITY };
            if let Some(again) = aggregate.intersect(&away, RayFilter::default(), &mut stack) {
                // The tessellated sphere is convex up to rounding: a grazing ray may hit an adjacent triangle.
                assert_ne!(again.triangle().triangle, hit.triangle().triangle, "left and hit the same triangle");
            }
            // Inwards: the ray must hit the other side.
            let inwards = Ray { origin: surface.spawn_origin(-direction), direction: -direction, t_max: f32::INFINITY };
            assert!(aggregate.intersect(&inwards, RayFilter::default(), &mut stack).is_some(), "a ray leaked at {far}");
        }
    }
}
