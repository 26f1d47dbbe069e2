//! Named expressions.

use crate::scene::Expression;

/// An expression with a name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum NamedExpression {
    /// Relaxed.
    Neutral,
    /// Mouth closed.
    SoftSmile,
    /// Teeth shown.
    Smile,
    /// Mouth open.
    Laugh,
    /// Brows down a little, lips together.
    Serious,
    /// Lids closed.
    EyesClosed,
}

impl NamedExpression {
    /// All expressions, in list order.
    pub const ALL: [NamedExpression; 6] = [
        NamedExpression::Neutral,
        NamedExpression::SoftSmile,
        NamedExpression::Smile,
        NamedExpression::Laugh,
        NamedExpression::Serious,
        NamedExpression::EyesClosed,
    ];

    /// Returns the label in lists.
    pub fn label(self) -> &'static str {
        match self {
            NamedExpression::Neutral => "Neutral",
            NamedExpression::SoftSmile => "Soft smile",
            NamedExpression::Smile => "Smile",
            NamedExpression::Laugh => "Laugh",
            NamedExpression::Serious => "Serious",
            NamedExpression::EyesClosed => "Eyes closed",
        }
    }

    /// Returns the expression.
    pub fn expression(self) -> Expression {
        let neutral = Expression::default();
        match self {
            NamedExpression::Neutral => neutral,
            NamedExpression::SoftSmile => Expression { smile: 0.4, ..neutral },
            NamedExpression::Smile => Expression { smile: 0.7, teeth: 0.55, ..neutral },
            NamedExpression::Laugh => Expression { smile: 0.85, teeth: 0.7, mouth_open: 0.3, squint: 0.2, ..neutral },
            NamedExpression::Serious => Expression { brows_down: 0.15, lips_pressed: 0.25, eyes_wide: 0.4, ..neutral },
            NamedExpression::EyesClosed => Expression { eyes_closed: 1.0, ..neutral },
        }
    }
}
