//! The body and the face of a figure.

use super::parameter::parameters;

parameters! {
    /// Body measures. Ethnicities are shares: only their ratio counts.
    Body {
        /// 0 female, 1 male.
        sex: "Sex", 0.0 to 1.0, 0.0;
        /// Age, years.
        age_years: "Age", 3.0 to 90.0, 30.0;
        /// Height without shoes, metres.
        height_m: "Height", 0.8 to 2.2, 1.7;
        /// 0 lean, 1 athletic.
        muscle: "Muscle", 0.0 to 1.0, 0.5;
        /// 0 thin, 1 heavy.
        weight: "Weight", 0.0 to 1.0, 0.5;
        /// Share of African features.
        african: "African", 0.0 to 1.0, 0.0;
        /// Share of Asian features.
        asian: "Asian", 0.0 to 1.0, 0.0;
        /// Share of European features.
        european: "European", 0.0 to 1.0, 1.0;
    }
}

parameters! {
    /// Features of a face, each from -1 to 1; 0 is the mean of body measures and age.
    Face {
        /// Width of the head.
        width: "Face width", -1.0 to 1.0, 0.0;
        /// Height of the forehead.
        forehead: "Forehead", -1.0 to 1.0, 0.0;
        /// Strength of the cheekbones.
        cheekbones: "Cheekbones", -1.0 to 1.0, 0.0;
        /// Fullness of the cheeks.
        cheeks: "Cheeks", -1.0 to 1.0, 0.0;
        /// Width of the chin.
        jaw: "Jaw width", -1.0 to 1.0, 0.0;
        /// Height of the chin.
        chin: "Chin height", -1.0 to 1.0, 0.0;
        /// The chin forwards.
        chin_forward: "Chin forward", -1.0 to 1.0, 0.0;
        /// Size of the eyes.
        eye_size: "Eye size", -1.0 to 1.0, 0.0;
        /// Distance of the eyes.
        eye_distance: "Eyes apart", -1.0 to 1.0, 0.0;
        /// Outer corners of the eyes upwards.
        eye_slant: "Eye slant", -1.0 to 1.0, 0.0;
        /// Height of the brows.
        brows: "Brow height", -1.0 to 1.0, 0.0;
        /// Length of the nose.
        nose_length: "Nose length", -1.0 to 1.0, 0.0;
        /// Width of the nose.
        nose_width: "Nose width", -1.0 to 1.0, 0.0;
        /// Bridge of the nose, from hollow to humped.
        nose_bridge: "Nose bridge", -1.0 to 1.0, 0.0;
        /// Tip of the nose upwards.
        nose_tip: "Nose tip", -1.0 to 1.0, 0.0;
        /// Width of the mouth.
        mouth_width: "Mouth width", -1.0 to 1.0, 0.0;
        /// Fullness of the lips.
        lips: "Lips", -1.0 to 1.0, 0.0;
        /// Size of the ears.
        ears: "Ears", -1.0 to 1.0, 0.0;
    }
}

parameters! {
    /// An expression: strengths from 0 to 1.
    Expression {
        /// Corners of the mouth up, cheeks raised.
        smile: "Smile", 0.0 to 1.0, 0.0;
        /// Lips apart, so that the teeth show.
        teeth: "Teeth", 0.0 to 1.0, 0.0;
        /// Jaw dropped.
        mouth_open: "Mouth open", 0.0 to 1.0, 0.0;
        /// Corners of the mouth down.
        frown: "Frown", 0.0 to 1.0, 0.0;
        /// Lips pressed together.
        lips_pressed: "Lips pressed", 0.0 to 1.0, 0.0;
        /// Lips forwards.
        pucker: "Pucker", 0.0 to 1.0, 0.0;
        /// Brows raised.
        brows_up: "Brows up", 0.0 to 1.0, 0.0;
        /// Brows drawn together.
        brows_down: "Brows down", 0.0 to 1.0, 0.0;
        /// Lower lids raised.
        squint: "Squint", 0.0 to 1.0, 0.0;
        /// Lids wide open.
        eyes_wide: "Eyes wide", 0.0 to 1.0, 0.0;
        /// Lids closed.
        eyes_closed: "Eyes closed", 0.0 to 1.0, 0.0;
        /// Left eye closed.
        wink: "Wink", 0.0 to 1.0, 0.0;
    }
}
