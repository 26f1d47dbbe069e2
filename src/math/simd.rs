//! Plain loops over arrays, compiled once for every processor of a kind and once for those with wider registers.
//!
//! The compiler turns loops without jumps into vector instructions of what it may assume: four numbers at a time on
//! any x86-64, eight with AVX2. [`widest`] asks the processor which of the two it can run. Nothing is fused or
//! reordered in either, so both give the same bits.

/// Proof that the processor has AVX2: only [`widest`] gives it out.
#[derive(Clone, Copy, Debug)]
pub struct Avx2(());

/// SimdTask that is compiled for each set of instructions. `run` and all it calls must be `#[inline(always)]`, or closures
/// that are called where they stand: what is called in the common way is compiled for every processor.
pub trait SimdTask {
    /// What comes out.
    type Output;

    /// Does the work. What is written in intrinsics can ask for the proof; loops need not.
    fn run(self, avx2: Option<Avx2>) -> Self::Output;
}

/// Does the work with the dispatch registers that the processor has.
#[inline]
pub fn dispatch<W: SimdTask>(work: W) -> W::Output {
    #[cfg(target_arch = "x86_64")]
    if std::arch::is_x86_feature_detected!("avx2") {
        #[expect(unsafe_code, reason = "a call into code made for AVX2, behind the check that the processor has it")]
        // SAFETY: the processor has AVX2; it was asked on the line above.
        return unsafe { compiled_for_avx2(work) };
    }
    work.run(None)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn compiled_for_avx2<W: SimdTask>(work: W) -> W::Output {
    work.run(Some(Avx2(())))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sums, quotients, roots and products that a fused multiply-add would round otherwise.
    struct Lengths<'a>(&'a [[f32; 64]; 3]);

    impl SimdTask for Lengths<'_> {
        type Output = [f32; 64];

        #[inline(always)]
        fn run(self, _: Option<Avx2>) -> [f32; 64] {
            let [x, y, z] = self.0;
            std::array::from_fn(|i| (x[i] * x[i] + y[i] * y[i] + z[i] * z[i]).sqrt() / (1.0 + x[i] * y[i]))
        }
    }

    #[test]
    fn wide_registers_give_the_bits_of_narrow_ones() {
        let numbers = [0.1_f32, 0.7, -0.3].map(|a| std::array::from_fn(|i| (a * i as f32).sin()));
        assert_eq!(dispatch(Lengths(&numbers)), Lengths(&numbers).run(None));
    }
}
