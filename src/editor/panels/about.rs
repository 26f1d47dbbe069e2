//! The window about the program: version, licences, what comes with it.

use eframe::egui::{self, Align2, Context, Grid, Label, RichText, Ui};

const REPOSITORY: &str = env!("CARGO_PKG_REPOSITORY");

/// What comes with the program, with its source and licence.
const BUNDLED: [(&str, &str, &str); 6] = [
    ("Catchlight, studios", "Its own", "MIT or Apache-2.0"),
    ("Figures", "Body data of MakeHuman", "CC0"),
    ("Denoiser's weights", "Intel Open Image Denoise", "Apache-2.0"),
    ("Letters", "Ubuntu Light", "Ubuntu Font Licence"),
    ("Digits", "Hack", "MIT, Bitstream Vera"),
    ("Signs", "Noto Emoji; Emoji Icon Font", "SIL OFL 1.1; MIT"),
];

/// Draws the window; `open` becomes false when it is closed.
pub fn about_ui(ctx: &Context, open: &mut bool) {
    egui::Window::new("About Catchlight")
        .open(open)
        .resizable(false)
        .collapsible(false)
        .pivot(Align2::CENTER_CENTER)
        .default_pos(ctx.content_rect().center())
        .show(ctx, |ui| {
            ui.set_width(430.0);
            text_ui(ui);
        });
}

fn text_ui(ui: &mut Ui) {
    ui.label(RichText::new("Catchlight").heading().strong());
    ui.label(RichText::new(concat!("Version ", env!("CARGO_PKG_VERSION"))).weak());
    wrapped(ui, RichText::new(env!("CARGO_PKG_DESCRIPTION")));
    if let Some(link) = Some(REPOSITORY).filter(|link| !link.is_empty()) {
        ui.hyperlink(link);
    }
    ui.separator();
    Grid::new("licences").num_columns(3).spacing([18.0, 3.0]).show(ui, |ui| {
        for (what, source, licence) in BUNDLED {
            ui.label(RichText::new(what).strong());
            ui.label(source);
            ui.label(licence);
            ui.end_row();
        }
    });
    ui.add_space(4.0);
    let libraries = "Catchlight contains libraries in Rust, among them egui, wgpu, rayon and image, each under its own \
                     free licence. Packages of Catchlight list them with their texts in licences.txt.";
    wrapped(ui, RichText::new(libraries).weak().small());
}

fn wrapped(ui: &mut Ui, text: RichText) {
    ui.add(Label::new(text).wrap());
}
