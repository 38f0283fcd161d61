// Meshes of a scene: light, shadow, identity. Lengths in millimetres, world axes.

struct Pass {
    // Clip space from world.
    camera: mat4x4f,
    // Clip space of the lamp from world.
    lamp: mat4x4f,
    // Eye; shadow texel as share of the map, 0 without shadows.
    eye: vec4f,
    // Lamp; its brightness.
    light: vec4f,
    // Unit axis of the lamp's beam; half width of the patch as tangent.
    beam: vec4f,
    // Horizontal unit vector of the patch; half height of the patch as tangent.
    patch_axis: vec4f,
    // Strength of the relief; exposure; whether the target takes sRGB numbers instead of light; least roughness.
    looks: vec4f,
};

struct Part {
    world: mat4x4f,
    // Wrap for red, green, blue; reflectance at normal incidence.
    material: vec4f,
    // Colour of the identity picture.
    identity: vec4f,
    // The same numbers of all materials.
    materials: array<vec4f, 5>,
};

@group(0) @binding(0) var<uniform> pass_: Pass;
@group(0) @binding(1) var shadow_map: texture_depth_2d;
@group(0) @binding(2) var shadow_sampler: sampler_comparison;
@group(1) @binding(0) var<uniform> part: Part;

struct Vertex {
    @location(0) rest: vec3f,
    @location(1) albedo: vec4f,
    @location(2) finish: vec4f,
    @location(3) at: vec3f,
    @location(4) normal: vec3f,
    @location(5) blood: f32,
};

struct Lit {
    @builtin(position) clip: vec4f,
    @location(0) at: vec3f,
    @location(1) normal: vec3f,
    @location(2) rest: vec3f,
    @location(3) albedo: vec3f,
    @location(4) finish: vec4f,
    @location(5) blood: f32,
};

// Linear light of sRGB, to a hundredth, without powers: a processor without graphics pays for each.
fn linear(c: vec3f) -> vec3f {
    return c * (c * (c * 0.3053 + 0.6822) + 0.0125);
}

// (1 - x)^5, Schlick's term.
fn fifth(x: f32) -> f32 {
    let y = 1.0 - x;
    let y2 = y * y;
    return y2 * y2 * y;
}

fn hash(p: vec3f) -> f32 {
    let q = fract(p * vec3f(0.1031, 0.1030, 0.0973));
    let r = q + dot(q, q.yzx + 33.33);
    return fract((r.x + r.y) * r.z);
}

// Value noise of period 1, -1 to 1.
fn noise(p: vec3f) -> f32 {
    let i = floor(p);
    let f = p - i;
    let u = f * f * (3.0 - 2.0 * f);
    let a = mix(mix(hash(i), hash(i + vec3f(1.0, 0.0, 0.0)), u.x),
                mix(hash(i + vec3f(0.0, 1.0, 0.0)), hash(i + vec3f(1.0, 1.0, 0.0)), u.x), u.y);
    let b = mix(mix(hash(i + vec3f(0.0, 0.0, 1.0)), hash(i + vec3f(1.0, 0.0, 1.0)), u.x),
                mix(hash(i + vec3f(0.0, 1.0, 1.0)), hash(i + vec3f(1.0, 1.0, 1.0)), u.x), u.y);
    return 2.0 * mix(a, b, u.z) - 1.0;
}

// Gradient of a noise with features of the given size, per millimetre.
fn slope(p: vec3f, size: f32) -> vec3f {
    let q = p / size;
    let e = 0.25;
    let middle = noise(q);
    return vec3f(noise(q + vec3f(e, 0.0, 0.0)) - middle,
                 noise(q + vec3f(0.0, e, 0.0)) - middle,
                 noise(q + vec3f(0.0, 0.0, e)) - middle) / (e * size);
}

// Depth of stippling at a place: pits of 0.1 to 0.3 mm in cells of 0.67 mm.
fn pits(p: vec3f) -> f32 {
    let q = p / 0.67;
    let cell = floor(q);
    var deepest = 0.0;
    for (var k = 0u; k < 8u; k++) {
        let side = vec3f(f32(k & 1u), f32((k >> 1u) & 1u), f32((k >> 2u) & 1u));
        let near = cell + side * sign(fract(q) - 0.5);
        let jitter = vec3f(hash(near), hash(near + 17.3), hash(near + 41.7));
        let away = distance(q, near + 0.2 + 0.6 * jitter) * 0.67;
        let radius = 0.10 + 0.20 * hash(near + 5.1);
        deepest = max(deepest, 1.0 - smoothstep(0.0, radius, away));
    }
    return deepest;
}

fn pit_slope(p: vec3f) -> vec3f {
    let e = 0.03;
    let middle = pits(p);
    return vec3f(pits(p + vec3f(e, 0.0, 0.0)) - middle,
                 pits(p + vec3f(0.0, e, 0.0)) - middle,
                 pits(p + vec3f(0.0, 0.0, e)) - middle) / e;
}

// Share of the lamp's patch at a place: an ellipse with a soft border.
fn patch_share(at: vec3f) -> f32 {
    let away = at - pass_.light.xyz;
    let depth = max(dot(away, pass_.beam.xyz), 1.0);
    let across = pass_.patch_axis.xyz;
    let x = dot(away, across) / depth / pass_.beam.w;
    let y = dot(away, cross(pass_.beam.xyz, across)) / depth / pass_.patch_axis.w;
    return 1.0 - smoothstep(0.75, 1.15, length(vec2f(x, y)));
}

// Samples of the shadow map; their largest distance as share of the map; light left in the deepest shadow.
const TAPS = 20u;
const PENUMBRA = 0.011;
const DEEPEST = 0.22;

fn shadow(at: vec3f, normal: vec3f) -> f32 {
    if (pass_.eye.w == 0.0) {
        return 1.0;
    }
    let clip = pass_.lamp * vec4f(at + normal * 0.5, 1.0);
    let place = clip.xyz / clip.w;
    let uv = vec2f(0.5 + 0.5 * place.x, 0.5 - 0.5 * place.y);
    // The lamp is some 100 mm wide, and its reflectors reach behind thin objects: a border of a millimetre or two, and
    // light left in the shadow.
    var lit = 0.0;
    for (var k = 0u; k < TAPS; k++) {
        let r = PENUMBRA * sqrt((f32(k) + 0.5) / f32(TAPS));
        let turn = 2.39996 * f32(k);
        let off = r * vec2f(cos(turn), sin(turn));
        lit += textureSampleCompareLevel(shadow_map, shadow_sampler, uv + off, place.z - 0.0004);
    }
    lit = mix(DEEPEST, 1.0, lit / f32(TAPS));
    let outside = any(uv < vec2f(0.0)) || any(uv > vec2f(1.0));
    return select(lit, 1.0, outside);
}

// One lobe of a microfacet highlight (GGX, Schlick's Fresnel term, Hammon's visibility).
fn lobe(n_h: f32, n_v: f32, n_l: f32, v_h: f32, roughness: f32, f0: f32) -> f32 {
    // The lamp's own size widens the highlight.
    let alpha = roughness * roughness + 0.05;
    let a2 = alpha * alpha;
    let d = n_h * n_h * (a2 - 1.0) + 1.0;
    let fresnel = f0 + (1.0 - f0) * fifth(v_h);
    let visible = 0.5 / max(mix(2.0 * n_l * n_v, n_l + n_v, alpha), 0.01);
    return a2 / (3.14159 * d * d) * visible * fresnel * n_l;
}

// Room around the patient that steel reflects: near the mouth flesh below, elsewhere a dim floor, a bright room above.
fn room(at: vec3f, along: vec3f) -> vec3f {
    let up = smoothstep(-0.35, 0.75, along.z);
    let side = 0.55 + 0.45 * smoothstep(-0.25, 0.25, sin(5.0 * along.x + 2.0 * along.y));
    let below = mix(vec3f(0.07, 0.03, 0.027), vec3f(0.12, 0.125, 0.13), smoothstep(5.0, 40.0, at.z));
    return mix(below, vec3f(0.62, 0.64, 0.66) * side, up);
}

fn shade(at: vec3f, smooth_normal: vec3f, bumped: vec3f, colour: vec3f, finish: vec4f, blood: f32, lit: f32, material: vec4f) -> vec3f {
    let f0 = material.w;
    let is_metal = f0 > 0.3;
    let wet = smoothstep(0.42, 0.58, blood);
    let albedo = mix(colour, vec3f(0.30, 0.018, 0.012), wet);
    let roughness = mix(finish.x, 0.22, wet);
    let open = finish.w;
    let to_lamp = pass_.light.xyz - at;
    let l = normalize(to_lamp);
    let v = normalize(pass_.eye.xyz - at);
    let h = normalize(l + v);
    let key = pass_.light.w * patch_share(at) * lit * mix(1.0, open, 0.45);
    let wrap = material.xyz;
    let diffuse = max(vec3f(0.0), (vec3f(dot(smooth_normal, l)) + wrap) / (1.0 + wrap)) / (1.0 + wrap);
    // Multiple bounces between surfaces of this colour (Jimenez, "Practical realtime strategies", 2016).
    let a = 2.0404 * albedo - 0.3324;
    let b = -4.7951 * albedo + 0.6417;
    let c = 2.7552 * albedo + 0.6903;
    let bounced = max(vec3f(open), ((open * a + b) * open + c) * open);
    let above = 0.5 + 0.5 * smooth_normal.z;
    let fill = mix(vec3f(0.30, 0.12, 0.10) * 0.30, vec3f(0.16, 0.16, 0.165), above) * bounced;
    let n_v = max(dot(bumped, v), 0.02);
    let n_l = max(dot(bumped, l), 0.0);
    let n_h = max(dot(bumped, h), 0.0);
    let v_h = max(dot(v, h), 0.0);
    let shine = key * open * (0.85 * lobe(n_h, n_v, n_l, v_h, 0.75 * roughness, f0)
                            + 0.15 * lobe(n_h, n_v, n_l, v_h, min(1.3 * roughness, 1.0), f0));
    if (is_metal) {
        let along = reflect(-v, bumped);
        let tint = albedo / max(max(albedo.r, max(albedo.g, albedo.b)), 0.001);
        // Black bands are matt paint on the steel.
        let steel = clamp(max(albedo.r, max(albedo.g, albedo.b)) * 2.2, 0.03, 1.0);
        let sheen = (key + 0.25) * max(dot(smooth_normal, l), 0.0) * roughness;
        return steel * tint * (0.75 * room(at, along) + 2.2 * shine + 0.3 * sheen) + 0.25 * shine;
    }
    // Surfaces that fade into the dark of the mouth have no film either.
    let there = smoothstep(0.02, 0.15, max(albedo.r, max(albedo.g, albedo.b)));
    // Light through thin edges.
    let against = max(0.0, dot(v, -normalize(l + 0.2 * smooth_normal)));
    let through = finish.z * 0.25 * against * against * against * against * against * against;
    let film = room(at, reflect(-v, bumped)) * (f0 + (1.0 - f0) * fifth(n_v)) * open * (1.0 - roughness) * 0.6;
    return albedo * (diffuse * key + fill + through * key) + (vec3f(3.2 * shine) + film) * there;
}

// Soft shoulder over 0.7.
fn develop(light: vec3f) -> vec3f {
    let c = light * pass_.looks.y;
    let over = max(c - 0.7, vec3f(0.0));
    let high = 0.7 + over * 0.3 / (0.3 + over);
    return select(c, high, c > vec3f(0.7));
}

// Numbers for the target: sRGB without powers, to two thousandths, where the target does not code light itself.
fn coded(light: vec3f) -> vec3f {
    if (pass_.looks.z == 0.0) {
        return light;
    }
    let c = max(light, vec3f(0.0));
    let s1 = sqrt(c);
    let s2 = sqrt(s1);
    let s3 = sqrt(s2);
    let high = 0.662002687 * s1 + 0.684122060 * s2 - 0.323583601 * s3 - 0.0225411470 * c;
    return select(high, 12.92 * c, c <= vec3f(0.0031308));
}

@vertex
fn vertex_for_pixels(in: Vertex) -> Lit {
    let at = part.world * vec4f(in.at, 1.0);
    var out: Lit;
    out.clip = pass_.camera * at;
    out.at = at.xyz;
    out.normal = (part.world * vec4f(in.normal, 0.0)).xyz;
    out.rest = in.rest;
    out.albedo = linear(in.albedo.rgb);
    out.finish = in.finish;
    out.blood = in.blood;
    return out;
}

@fragment
fn lit_pixel(in: Lit) -> @location(0) vec4f {
    let n = normalize(in.normal);
    var bumped = n;
    var albedo = in.albedo;
    let amount = pass_.looks.x;
    if (amount > 0.0 && part.material.w < 0.3) {
        // Undulation of 0.05 mm breaks the highlights; teeth are smoother.
        let flesh = step(part.material.z, 0.15);
        var relief = slope(in.rest, 2.6) * mix(0.012, 0.05, flesh);
        if (in.finish.y > 0.02) {
            relief -= pit_slope(in.rest) * 0.035 * in.finish.y;
            albedo *= 1.0 - 0.10 * in.finish.y * pits(in.rest);
        }
        relief -= n * dot(relief, n);
        bumped = normalize(n - relief * amount);
    }
    let light = shade(in.at, n, bumped, albedo, in.finish, in.blood, shadow(in.at, n), part.material);
    return vec4f(develop(light), 1.0);
}

struct Flat {
    @builtin(position) clip: vec4f,
    @location(0) light: vec3f,
};

@vertex
fn lit_vertex(in: Vertex) -> Flat {
    let at = part.world * vec4f(in.at, 1.0);
    let n = normalize((part.world * vec4f(in.normal, 0.0)).xyz);
    var out: Flat;
    out.clip = pass_.camera * at;
    // A vertex cannot carry a highlight smaller than its triangles.
    var finish = in.finish;
    finish.x = max(finish.x, pass_.looks.w);
    let material = part.materials[u32(in.albedo.a * 255.0 + 0.5)];
    out.light = coded(develop(shade(at.xyz, n, n, linear(in.albedo.rgb), finish, in.blood, 1.0, material)));
    return out;
}

@fragment
fn flat_pixel(in: Flat) -> @location(0) vec4f {
    return vec4f(in.light, 1.0);
}

@vertex
fn identity_vertex(in: Vertex) -> @builtin(position) vec4f {
    return pass_.camera * part.world * vec4f(in.at, 1.0);
}

@fragment
fn identity_pixel() -> @location(0) vec4f {
    return part.identity;
}

@vertex
fn shadow_vertex(in: Vertex) -> @builtin(position) vec4f {
    return pass_.lamp * part.world * vec4f(in.at, 1.0);
}
