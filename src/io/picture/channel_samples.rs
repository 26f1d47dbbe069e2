//! The samples of an EXR channel, computed line by line while the file is written: no channel is in memory as a whole.

use exr::block::lines::LineRefMut;
use exr::error::UnitResult;
use exr::image::write::samples::{SamplesWriter, WritableSamples};
use exr::math::RoundingMode;
use exr::meta::attribute::{LevelMode, SampleType};
use exr::meta::header::Header;
use exr::prelude::{AnyChannel, AnyChannels, Image, Layer, Layers};
use std::fmt;

/// An EXR image of several parts.
pub(super) type ExrImage<'a> = Image<Layers<AnyChannels<ChannelSamples<'a>>>>;
/// A part of an EXR image.
pub(super) type ExrPart<'a> = Layer<AnyChannels<ChannelSamples<'a>>>;
/// A channel of a part.
pub(super) type ExrChannel<'a> = AnyChannel<ChannelSamples<'a>>;

/// Returns the sample at (x, y), y down.
type Sampler<'a, T> = Box<dyn Fn(usize, usize) -> T + Sync + 'a>;

/// The samples of a channel.
pub(super) enum ChannelSamples<'a> {
    F32(Sampler<'a, f32>),
    U32(Sampler<'a, u32>),
}

impl<'a> ChannelSamples<'a> {
    /// Returns the samples that a function computes at (x, y), y down.
    pub fn f32(sample: impl Fn(usize, usize) -> f32 + Sync + 'a) -> Self {
        ChannelSamples::F32(Box::new(sample))
    }

    /// As [`ChannelSamples::f32`], for unsigned integers.
    pub fn u32(sample: impl Fn(usize, usize) -> u32 + Sync + 'a) -> Self {
        ChannelSamples::U32(Box::new(sample))
    }
}

impl<'s> WritableSamples<'s> for ChannelSamples<'_> {
    type Writer = LineWriter<'s>;

    fn sample_type(&self) -> SampleType {
        match self {
            ChannelSamples::F32(_) => SampleType::F32,
            ChannelSamples::U32(_) => SampleType::U32,
        }
    }

    fn infer_level_modes(&self) -> (LevelMode, RoundingMode) {
        (LevelMode::Singular, RoundingMode::Down)
    }

    fn create_samples_writer(&'s self, _: &Header) -> Self::Writer {
        LineWriter(self)
    }
}

/// Writes lines of a channel.
pub(super) struct LineWriter<'a>(&'a ChannelSamples<'a>);

impl SamplesWriter for LineWriter<'_> {
    fn extract_line(&self, line: LineRefMut<'_>) {
        // Into a buffer that has the length of the line: writing cannot fail.
        let _: UnitResult = write_line(self.0, line);
    }
}

fn write_line(samples: &ChannelSamples<'_>, line: LineRefMut<'_>) -> UnitResult {
    let (left, y) = (line.location.position.x(), line.location.position.y());
    match samples {
        ChannelSamples::F32(sample) => line.write_samples(|x| sample(left + x, y)),
        ChannelSamples::U32(sample) => line.write_samples(|x| sample(left + x, y)),
    }
}

impl fmt::Debug for ChannelSamples<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "samples of type {:?}", self.sample_type())
    }
}
