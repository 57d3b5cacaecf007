//! Colours that colour-blind readers tell apart.

/// A colour for lines, and a darker one for text that names them on white.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Colour {
    /// For lines, areas and symbols.
    pub line: &'static str,
    /// For text, with a contrast of at least 4.5 on white.
    pub text: &'static str,
}

/// Black.
pub const BLACK: Colour = Colour { line: "#000000", text: "#000000" };
/// Blue of Okabe and Ito.
pub const BLUE: Colour = Colour { line: "#0072B2", text: "#00598C" };
/// Bluish green of Okabe and Ito.
pub const GREEN: Colour = Colour { line: "#009E73", text: "#00684C" };
/// Orange of Okabe and Ito.
pub const ORANGE: Colour = Colour { line: "#E69F00", text: "#855C00" };
/// Vermillion of Okabe and Ito.
pub const VERMILLION: Colour = Colour { line: "#D55E00", text: "#A34700" };
/// Reddish purple of Okabe and Ito.
pub const PURPLE: Colour = Colour { line: "#CC79A7", text: "#8E3F6C" };
/// Grey, for the background.
pub const GREY: Colour = Colour { line: "#767676", text: "#555555" };

/// A ramp from light to dark blue, for curves in an order.
pub fn ramp(index: usize, count: usize) -> Colour {
    const BLUES: [Colour; 6] = [
        Colour { line: "#8CC5E3", text: "#1F6F9C" },
        Colour { line: "#5BA7D1", text: "#1F6F9C" },
        Colour { line: "#2E86BC", text: "#1B6799" },
        Colour { line: "#11679E", text: "#11679E" },
        Colour { line: "#0A4B77", text: "#0A4B77" },
        Colour { line: "#052D49", text: "#052D49" },
    ];
    if count < 2 {
        return BLUES[3];
    }
    BLUES[(index * (BLUES.len() - 1) / (count - 1)).min(BLUES.len() - 1)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_in_an_order_get_darker() {
        assert_eq!(ramp(0, 2).line, "#8CC5E3");
        assert_eq!(ramp(1, 2).line, "#052D49");
        assert_eq!(ramp(0, 1).line, "#11679E");
    }
}
