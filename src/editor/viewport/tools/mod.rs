//! Tools that move things in the viewport: transform handles, typed amounts, placing a light by its highlight or light.

pub mod click_pick;
pub mod floor_handle;
pub mod handle_pointer;
pub mod marquee_selection;
pub mod place_light;
pub mod place_light_drag;
pub mod surface_pick;
pub mod transform_handles;
pub mod transform_selection;
pub mod typed_number;
