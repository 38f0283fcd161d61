// Rectangles and glyphs of the panel, in pixels from the upper left corner.

struct Size { pixels: vec4f };

@group(0) @binding(0) var<uniform> size: Size;
@group(0) @binding(1) var atlas: texture_2d<f32>;

struct Corner {
    @location(0) at: vec2f,
    // Texel of the atlas.
    @location(1) texel: vec2f,
    // Linear colour with alpha.
    @location(2) colour: vec4f,
};

struct Drawn {
    @builtin(position) clip: vec4f,
    @location(0) texel: vec2f,
    @location(1) colour: vec4f,
};

@vertex
fn vertex(in: Corner) -> Drawn {
    var out: Drawn;
    let ndc = in.at / size.pixels.xy * 2.0 - 1.0;
    out.clip = vec4f(ndc.x, -ndc.y, 0.0, 1.0);
    out.texel = in.texel;
    out.colour = in.colour;
    return out;
}

@fragment
fn pixel(in: Drawn) -> @location(0) vec4f {
    let cover = textureLoad(atlas, vec2u(in.texel), 0).r;
    return vec4f(in.colour.rgb, in.colour.a * cover);
}
