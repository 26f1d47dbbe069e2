//! The sheet as a web page in one file: its tables become cards on a phone.

use super::content::{MEASURES, SheetContent};
use super::font::Font;
use super::light_facts::COLUMNS;
use super::page::view_drawing;
use super::svg::{FONTS, color, escaped, svg};
use std::fmt::Write;

/// Width of a view, millimetres: its text is as large as the text around it on a phone.
const VIEW_MM: f32 = 75.0;

const STYLE: &str = "
body { margin: 0 auto; padding: 16px; max-width: 980px; color: #181818; background: #fff; line-height: 1.45 }
h1 { font-size: 1.7em; margin: 0 } h2 { font-size: 1.1em; margin: 1.4em 0 .4em }
.about, small { color: #666 } small { display: block; font-size: .8em }
.top { display: flex; flex-wrap: wrap; gap: 24px; margin-top: 16px }
.top > * { flex: 1 1 300px; min-width: 0 }
img, svg { max-width: 100%; height: auto; display: block }
dl { display: grid; grid-template-columns: 8em 1fr; gap: 2px 8px; margin: 0 } dt { color: #666 } dd { margin: 0 }
table { border-collapse: collapse; width: 100% }
th { text-align: left; font-weight: 400; color: #666; font-size: .85em } th, td { padding: 5px 10px 5px 0; vertical-align: top; border-bottom: 1px solid #ddd }
.number { display: inline-block; min-width: 1.5em; line-height: 1.5em; border-radius: 1em; text-align: center; color: #fff; margin-right: .5em }
td:first-child small { margin-left: 2.2em }
ul { margin: 0; padding-left: 1.2em }
@media (max-width: 640px) {
  thead { display: none } table, tbody { display: block }
  tr { display: grid; grid-template-columns: 1fr 1fr; border-bottom: 1px solid #ccc; padding: 8px 0 }
  td { display: block; border: 0; padding: 3px 8px 3px 0 } td:first-child, td:nth-child(2) { grid-column: 1 / 3 }
  td[data-name]::before { content: attr(data-name); display: block; color: #666; font-size: .75em }
}
@media print { body { max-width: none; padding: 0; font-size: 9pt } .top, tr, svg { break-inside: avoid } }
";

/// Returns the sheet as HTML; the picture is a `data:` address.
pub fn html(content: &SheetContent, picture: &str, font: &Font) -> String {
    let title = escaped(&content.title);
    let mut out = format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n\
         <meta name=\"generator\" content=\"Catchlight {}\"/>\n<title>{title}</title>\n\
         <style>body {{ font-family: {FONTS} }}{STYLE}</style>\n</head>\n<body>\n<h1>{title}</h1>\n\
         <p class=\"about\">{}</p>\n<div class=\"top\">\n<img src=\"{picture}\" alt=\"The planned picture\"/>\n<div>\n",
        env!("CARGO_PKG_VERSION"),
        escaped(&content.description)
    );
    for (heading, facts) in [("Camera", &content.camera), ("Subject", &content.subject)] {
        let _ = writeln!(out, "<h2>{heading}</h2>\n<dl>");
        for (name, value) in facts {
            let _ = writeln!(out, "<dt>{name}</dt><dd>{}</dd>", escaped(value));
        }
        out += "</dl>\n";
    }
    out += "</div>\n</div>\n<div class=\"top\">\n";
    for (index, heading) in ["Plan", "From the camera's right"].into_iter().enumerate() {
        let drawing = svg(&view_drawing(content, index, VIEW_MM, font), picture, &format!("view{index}-"));
        let _ = writeln!(out, "<div><h2>{}</h2>\n{drawing}</div>", escaped(heading));
    }
    let _ = writeln!(out, "</div>\n<p class=\"about\">{}</p>", escaped(&MEASURES.join(" ")));
    out += "<h2>Lights</h2>\n<table>\n<thead><tr>";
    for heading in COLUMNS {
        let _ = write!(out, "<th>{heading}</th>");
    }
    out += "</tr></thead>\n<tbody>\n";
    for light in &content.lights {
        out += "<tr>";
        for (index, (name, [line, small])) in COLUMNS.iter().zip(light.facts.cells()).enumerate() {
            let attribute = if index > 1 { format!(" data-name=\"{name}\"") } else { String::new() };
            let number = match index {
                0 => format!(
                    "<span class=\"number\" style=\"background:{}\">{}</span>",
                    color(light.color),
                    light.facts.number
                ),
                _ => String::new(),
            };
            let (line, small) = (escaped(&line), escaped(&small));
            let _ = write!(out, "<td{attribute}>{number}{line}<small>{small}</small></td>");
        }
        out += "</tr>\n";
    }
    out += "</tbody>\n</table>\n<div class=\"top\">\n";
    let gear: Vec<String> = content.gear.iter().map(|(count, name)| format!("{count} x {name}")).collect();
    for (heading, list) in [("Bring", &gear), ("Check on the set", &content.checks)] {
        let _ = writeln!(out, "<div><h2>{heading}</h2>\n<ul>");
        for item in list {
            let _ = writeln!(out, "<li>{}</li>", escaped(item));
        }
        out += "</ul></div>\n";
    }
    out += "</div>\n</body>\n</html>\n";
    out
}
