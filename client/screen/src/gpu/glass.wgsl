// Glass of a mirror: samples the picture of the reflected pass.

struct Glass {
    camera: mat4x4f,
    world: mat4x4f,
    // Middle and half size of the glass's window in the main picture.
    window: vec4f,
    // Centre of the disc in the tool's frame, mm; radius.
    centre: vec4f,
    // Unit normal in the tool's frame; share of light reflected.
    normal: vec4f,
    // Fog 0 to 1; scratches 0 to 1; whether the reflected pass has a picture.
    looks: vec4f,
    // Used share of the texture along both edges; whether picture and target have sRGB numbers instead of light.
    used: vec4f,
    // Share of the picture's numbers, and numbers added: a glass without a picture has these alone.
    clean: vec4f,
};

@group(0) @binding(0) var<uniform> glass: Glass;
@group(0) @binding(1) var picture: texture_2d<f32>;
@group(0) @binding(2) var picture_sampler: sampler;

struct Place {
    @builtin(position) clip: vec4f,
    @location(0) ndc: vec4f,
    // Place on the disc, radii.
    @location(1) on: vec2f,
};

const SIDES = 64u;

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> Place {
    let side = index / 3u;
    let corner = index % 3u;
    var on = vec2f(0.0);
    if (corner > 0u) {
        let around = 6.2831853 * f32((side + corner - 1u) % SIDES) / f32(SIDES);
        on = vec2f(cos(around), sin(around));
    }
    let n = glass.normal.xyz;
    let aside = select(vec3f(0.0, 1.0, 0.0), vec3f(1.0, 0.0, 0.0), abs(n.x) < 0.9);
    let u = normalize(cross(n, aside));
    let v = cross(n, u);
    // Over the face of the tool's mesh by a hundredth of a millimetre.
    let at = glass.centre.xyz + (u * on.x + v * on.y) * glass.centre.w + n * 0.02;
    var out: Place;
    out.clip = glass.camera * glass.world * vec4f(at, 1.0);
    out.ndc = out.clip;
    out.on = on;
    return out;
}

// Light of the picture's numbers, and numbers for the target, to a hundredth, without powers.
fn linear(c: vec3f) -> vec3f {
    return select(c, c * (c * (c * 0.3053 + 0.6822) + 0.0125), glass.used.z > 0.5);
}

fn coded(light: vec3f) -> vec3f {
    let s1 = sqrt(light);
    let s2 = sqrt(s1);
    let s3 = sqrt(s2);
    let high = 0.662002687 * s1 + 0.684122060 * s2 - 0.323583601 * s3 - 0.0225411470 * light;
    return select(light, max(high, vec3f(0.0)), glass.used.z > 0.5);
}

fn hash(p: vec2f) -> f32 {
    return fract(sin(dot(p, vec2f(127.1, 311.7))) * 43758.5453);
}

@fragment
fn pixel(in: Place) -> @location(0) vec4f {
    let ndc = in.ndc.xy / in.ndc.w;
    let in_window = (ndc - glass.window.xy) / glass.window.zw;
    let uv = vec2f(0.5 + 0.5 * in_window.x, 0.5 - 0.5 * in_window.y) * glass.used.xy;
    var seen = linear(textureSampleLevel(picture, picture_sampler, uv, 0.0).rgb);
    seen = select(vec3f(0.16, 0.17, 0.18), seen * glass.normal.w, glass.looks.z > 0.5);
    // Fog lies thickest in the middle; breath clears from the rim.
    let fog = glass.looks.x * (1.0 - smoothstep(0.2, 1.1, length(in.on)));
    seen = mix(seen, vec3f(0.55, 0.57, 0.58), fog);
    let line = abs(fract(in.on.x * 3.1 + 0.9 * in.on.y + hash(floor(in.on * 4.0)) * 0.02) - 0.5);
    seen = mix(seen, vec3f(0.7), glass.looks.y * 0.5 * (1.0 - smoothstep(0.004, 0.012, line)));
    return vec4f(coded(seen), 1.0);
}

// Clean glass, without powers and branches: most of a picture's glass is drawn by a processor.
@fragment
fn clean(in: Place) -> @location(0) vec4f {
    let in_window = (in.ndc.xy / in.ndc.w - glass.window.xy) / glass.window.zw;
    let uv = vec2f(0.5 + 0.5 * in_window.x, 0.5 - 0.5 * in_window.y) * glass.used.xy;
    let seen = textureSampleLevel(picture, picture_sampler, uv, 0.0).rgb;
    // A share of light is the share's own number of sRGB numbers, to a hundredth.
    return vec4f(seen * glass.clean.x + glass.clean.yzw, 1.0);
}

@fragment
fn identity(in: Place) -> @location(0) vec4f {
    let ndc = in.ndc.xy / in.ndc.w;
    let in_window = (ndc - glass.window.xy) / glass.window.zw;
    let uv = vec2f(0.5 + 0.5 * in_window.x, 0.5 - 0.5 * in_window.y) * glass.used.xy;
    let size = vec2f(textureDimensions(picture));
    return textureLoad(picture, vec2u(clamp(uv * size, vec2f(0.0), size - 1.0)), 0);
}
