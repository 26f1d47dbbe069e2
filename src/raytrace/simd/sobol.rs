//! Tables and constants for the Owen-scrambled Sobol points of Burley 2020, "Practical Hash-based Owen Scrambling".

/// Bits of a point's index that are used.
const INDEX_BITS: usize = 16;

/// Points of the first four dimensions for each value of each four bits of a bit-reversed index, from its lowest used
/// bits up; a point is the exclusive or of four entries. The entries are bit-reversed: the scramble works on reversed
/// bits.
pub const NIBBLES: [[[u32; 4]; 16]; INDEX_BITS / 4] = nibbles();

/// Parameters of the first four dimensions (Joe and Kuo 2008): degree and inner coefficients of the primitive
/// polynomial, and the initial direction numbers m.
const DIMENSIONS: [(usize, u32, [u32; 3]); 4] =
    [(0, 0, [0; 3]), (1, 0, [1, 0, 0]), (2, 1, [1, 3, 0]), (3, 1, [1, 3, 1])];

/// Returns the direction numbers v of a dimension, the binary point before the highest bit.
const fn directions(dimension: usize) -> [u32; INDEX_BITS] {
    let (degree, coefficients, first) = DIMENSIONS[dimension];
    let mut v = [0; INDEX_BITS];
    let mut i = 0;
    while i < INDEX_BITS {
        v[i] = if degree == 0 {
            1 << (31 - i)
        } else if i < degree {
            first[i] << (31 - i)
        } else {
            let mut value = v[i - degree] ^ (v[i - degree] >> degree);
            let mut k = 1;
            while k < degree {
                if (coefficients >> (degree - 1 - k)) & 1 == 1 {
                    value ^= v[i - k];
                }
                k += 1;
            }
            value
        };
        i += 1;
    }
    v
}

const fn nibbles() -> [[[u32; 4]; 16]; INDEX_BITS / 4] {
    let mut table = [[[0; 4]; 16]; INDEX_BITS / 4];
    let mut dimension = 0;
    while dimension < 4 {
        let v = directions(dimension);
        let mut bit = 0;
        while bit < INDEX_BITS {
            // Bit 0 of the index is the highest bit of the reversed index.
            let reversed = INDEX_BITS - 1 - bit;
            let mut value = 0;
            while value < 16 {
                if (value >> (reversed % 4)) & 1 == 1 {
                    table[reversed / 4][value][dimension] ^= v[bit].reverse_bits();
                }
                value += 1;
            }
            bit += 1;
        }
        dimension += 1;
    }
    table
}

/// Seed of the index shuffle, which is independent of the dimensions' scrambles.
pub const SHUFFLE: u32 = 0x79c6_8e4a;
/// Factor on the seed.
pub const SEED_FACTOR: u32 = 0x9c8f_2d3b;
/// Seed of each dimension.
pub const DIMENSION_SEEDS: [u32; 4] = [0x912f_69ba, 0x174f_18ab, 0x691e_72ca, 0xb40c_c1b8];
/// Initial state of the hash: keeps zero from hashing to zero.
pub const HASH_START: u32 = 0xe6fe_3beb;
/// Factors of the hash.
pub const HASH_FACTORS: [u32; 2] = [0x7feb_352d, 0x846c_a68b];
/// Factors of the scramble (a Laine-Karras permutation).
pub const SCRAMBLE_FACTORS: [u32; 3] = [0x3d20_adea, 0x0552_6c56, 0x53a2_2864];

/// Hashes one number.
#[inline(always)]
pub fn hash(mut n: u32) -> u32 {
    n ^= HASH_START;
    n ^= n >> 16;
    n = n.wrapping_mul(HASH_FACTORS[0]);
    n ^= n >> 15;
    n = n.wrapping_mul(HASH_FACTORS[1]);
    n ^ n >> 16
}

/// Owen-scrambles a bit-reversed number.
#[inline(always)]
pub fn scramble(mut n: u32, by: u32) -> u32 {
    n ^= n.wrapping_mul(SCRAMBLE_FACTORS[0]);
    n = n.wrapping_add(by).wrapping_mul((by >> 16) | 1);
    n ^= n.wrapping_mul(SCRAMBLE_FACTORS[1]);
    n ^ n.wrapping_mul(SCRAMBLE_FACTORS[2])
}
