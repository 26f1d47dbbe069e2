"""Pictures in linear RGB, height x width x 3, and their errors."""

import numpy


def load(path):
    """Returns the colours of an OpenEXR file."""
    import OpenEXR

    channels = OpenEXR.File(str(path)).channels()
    packed = channels.get("RGB") or channels.get("RGBA")
    pixels = packed.pixels[..., :3] if packed else numpy.stack([channels[c].pixels for c in "RGB"], -1)
    return pixels.astype(numpy.float64)


class Reference:
    """The mean of two independent pictures, whose difference tells its own error."""

    def __init__(self, first, second):
        self.picture = (first + second) / 2
        self.scale = self.picture**2 + 0.01 * (self.picture**2).mean()
        self.own_error = ((first - second) ** 2 / 4 / self.scale).mean()

    def relative_mse(self, picture):
        """Returns the squared error relative to the square of the pixel plus 1 % of the mean square, less that of the
        reference itself."""
        return ((picture - self.picture) ** 2 / self.scale).mean() - self.own_error

    def flip(self, picture):
        """Returns the mean FLIP error (Andersson et al. 2020), both pictures exposed for a mean of 0.18."""
        import flip_evaluator

        exposure = 0.18 / self.picture.mean()
        shown = [srgb(exposure * each).astype(numpy.float32) for each in (self.picture, picture)]
        return float(flip_evaluator.evaluate(*shown, "LDR", applyMagma=False)[1])


def srgb(linear):
    linear = linear.clip(0.0, 1.0)
    return numpy.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
