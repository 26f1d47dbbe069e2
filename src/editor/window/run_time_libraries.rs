//! The libraries of the window system that winit opens at run time. A program that links none of them starts on any
//! machine, and winit panics where one is missing: the check is made before the window opens, by the crates that winit
//! opens them with, and names the Debian packages to install.
//!
//! Drivers for Vulkan and OpenGL are opened at run time, too, and each machine has its own: whether one of them draws is
//! known once the window is opened.

/// A library that is opened at run time.
#[derive(Clone, Copy)]
struct RunTimeLibrary {
    /// Its name for the dynamic linker.
    file: &'static str,
    /// The Debian package that has it.
    package: &'static str,
    /// Opens it. Libraries stay open.
    opens: fn() -> bool,
}

/// The libraries that are missing for a window, and the packages that have them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MissingLibraries {
    /// Names of the libraries.
    pub files: Vec<&'static str>,
    /// Debian packages, in the same order.
    pub packages: Vec<&'static str>,
}

/// Returns the libraries that are missing for a window on Wayland or on X11; none if all of them open.
pub fn missing(on_wayland: bool) -> Option<MissingLibraries> {
    absent(system::libraries(on_wayland))
}

fn absent(libraries: &[RunTimeLibrary]) -> Option<MissingLibraries> {
    let absent: Vec<&RunTimeLibrary> = libraries.iter().filter(|library| !(library.opens)()).collect();
    let files: Vec<_> = absent.iter().map(|library| library.file).collect();
    let packages = absent.iter().map(|library| library.package).collect();
    (!files.is_empty()).then_some(MissingLibraries { files, packages })
}

#[cfg(all(unix, not(target_os = "macos")))]
mod system {
    use super::RunTimeLibrary;

    const XKBCOMMON: RunTimeLibrary = RunTimeLibrary {
        file: "libxkbcommon.so.0",
        package: "libxkbcommon0",
        opens: || xkbcommon_dl::xkbcommon_option().is_some(),
    };

    const WAYLAND: [RunTimeLibrary; 2] = [
        RunTimeLibrary {
            file: "libwayland-client.so.0",
            package: "libwayland-client0",
            opens: wayland_sys::client::is_lib_available,
        },
        XKBCOMMON,
    ];

    const X11: [RunTimeLibrary; 7] = [
        RunTimeLibrary { file: "libX11.so.6", package: "libx11-6", opens: || x11_dl::xlib::Xlib::open().is_ok() },
        RunTimeLibrary {
            file: "libX11-xcb.so.1",
            package: "libx11-xcb1",
            opens: || x11_dl::xlib_xcb::Xlib_xcb::open().is_ok(),
        },
        RunTimeLibrary { file: "libxcb.so.1", package: "libxcb1", opens: || x11rb::xcb_ffi::load_libxcb().is_ok() },
        RunTimeLibrary {
            file: "libXcursor.so.1",
            package: "libxcursor1",
            opens: || x11_dl::xcursor::Xcursor::open().is_ok(),
        },
        RunTimeLibrary { file: "libXi.so.6", package: "libxi6", opens: || x11_dl::xinput2::XInput2::open().is_ok() },
        XKBCOMMON,
        RunTimeLibrary {
            file: "libxkbcommon-x11.so.0",
            package: "libxkbcommon-x11-0",
            opens: || xkbcommon_dl::x11::xkbcommon_x11_option().is_some(),
        },
    ];

    /// Returns the libraries of a window system.
    pub fn libraries(on_wayland: bool) -> &'static [RunTimeLibrary] {
        if on_wayland { &WAYLAND } else { &X11 }
    }
}

/// Windows and macOS bring their window system with them.
#[cfg(not(all(unix, not(target_os = "macos"))))]
mod system {
    use super::RunTimeLibrary;

    /// Returns no libraries.
    pub fn libraries(_on_wayland: bool) -> &'static [RunTimeLibrary] {
        &[]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_missing_libraries_are_named_with_their_packages() {
        let library = |file, package, opens: fn() -> bool| RunTimeLibrary { file, package, opens };
        let all = [
            library("libA.so.1", "liba1", || true),
            library("libB.so.2", "libb2", || false),
            library("libC.so.3", "libc3", || false),
        ];
        let missing = absent(&all).unwrap();
        assert_eq!((missing.files, missing.packages), (vec!["libB.so.2", "libC.so.3"], vec!["libb2", "libc3"]));
        assert_eq!(absent(&all[..1]), None);
    }
}
