//! Colours, the same on the page and in pictures.

/// A colour: red, green, blue.
pub type Rgb = [u8; 3];

/// Colours of bodies, taken in turn.
pub(crate) const HUES: [Rgb; 8] = [
    [0x4e, 0x79, 0xa7],
    [0xe0, 0x8e, 0x45],
    [0x5b, 0x9f, 0x78],
    [0xc2, 0x5b, 0x5f],
    [0x8b, 0x74, 0xb2],
    [0xc9, 0xa5, 0x45],
    [0x4f, 0xa3, 0xa5],
    [0xa9, 0x78, 0x7f],
];

/// Colours of what is no moving body.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Inks {
    pub(crate) ink: Rgb,
    pub(crate) soft: Rgb,
    pub(crate) fixed: Rgb,
    pub(crate) accent: Rgb,
}

const ON_LIGHT: Inks = Inks {
    ink: [0x23, 0x26, 0x2b],
    soft: [0x6d, 0x73, 0x80],
    fixed: [0xc9, 0xc5, 0xbb],
    accent: [0xc2, 0x41, 0x0c],
};

const ON_DARK: Inks = Inks {
    ink: [0xe6, 0xe8, 0xec],
    soft: [0x97, 0x9e, 0xab],
    fixed: [0x3a, 0x41, 0x4d],
    accent: [0xfb, 0x92, 0x3c],
};

impl Inks {
    /// Those that are seen on a background.
    pub(crate) fn on([r, g, b]: Rgb) -> Self {
        // Luma of Rec. 601, in thousandths.
        let luma = 299 * u32::from(r) + 587 * u32::from(g) + 114 * u32::from(b);
        if luma < 128_000 { ON_DARK } else { ON_LIGHT }
    }
}

/// A darker shade, for edges and marks.
pub(crate) fn shade(color: Rgb) -> Rgb {
    color.map(|c| u8::try_from(u16::from(c) * 11 / 20).unwrap_or(c))
}

/// As CSS writes it.
pub(crate) fn css([r, g, b]: Rgb) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}
