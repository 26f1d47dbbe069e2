//! Tools of the viewport: selection by click and box, transform handles with typed amounts, joints of figures, placing
//! a light by a feature.

pub mod click_pick;
pub mod handle_drag;
pub mod handle_part;
pub mod handle_pointer;
pub mod handle_view;
pub mod joint_handles;
pub mod marquee_selection;
pub mod place_light;
pub mod place_light_drag;
pub mod pointer_tool;
pub mod surface_pick;
pub mod tank_brush;
pub mod tool_pointer;
pub mod transform_handles;
pub mod transform_selection;
pub mod typed_number;
