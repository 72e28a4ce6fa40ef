//! Reads a PNG back.

/// A PNG.
pub struct Picture {
    /// Width and height.
    pub size: [u32; 2],
    /// Row by row.
    pub pixels: Vec<[u8; 3]>,
}

/// What a PNG holds: colours of eight bits, without transparency.
pub fn decoded(bytes: &[u8]) -> Picture {
    let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().expect("a PNG");
    let mut pixels = vec![0; reader.output_buffer_size().expect("a size")];
    let info = reader.next_frame(&mut pixels).expect("a whole PNG");
    assert_eq!((info.color_type, info.bit_depth), (png::ColorType::Rgb, png::BitDepth::Eight));
    Picture { size: [info.width, info.height], pixels: pixels.as_chunks().0.to_vec() }
}
