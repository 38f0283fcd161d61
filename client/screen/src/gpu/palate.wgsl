
// Upper jaw and cheeks of reflections: an open mouth's palate, gum and teeth, mm. They are decoration in bounced light:
// no scene has them, and no tool touches them. Shapes and colours are chosen.

// Teeth of a side, two of them the soft palate behind; columns of a tooth; rows from cheek to midline. The caller
// counts the same corners.
const TEETH = 9u;
const COLUMNS = 4u;
const ROWS = 10u;

struct Above {
    @builtin(position) clip: vec4f,
    @location(0) at: vec3f,
    @location(1) normal: vec3f,
    // Teeth from the midline, negative on the right; rows from the cheek.
    @location(2) place: vec2f,
};

// Point of the jaw. Neighbours meet at whole numbers of teeth.
fn upper(place: vec2f) -> vec3f {
    // y between neighbours, from the midline backwards, by the usual widths of upper teeth.
    var between = array<f32, 8>(0.0, 8.27, 13.06, 16.78, 19.34, 21.4, 23.83, 25.67);
    // Distance inwards from the arch, and height over the edges of the teeth, by row. The cheek begins below.
    var inwards = array<f32, 8>(-14.0, -14.5, -6.5, -4.6, -3.2, 3.2, 4.6, 7.5);
    var heights = array<f32, 8>(-34.0, 13.0, 11.0, 7.5, 0.0, 0.0, 7.0, 10.5);
    let q = min(abs(place.x), 6.999);
    let k = u32(q);
    let behind = max(abs(place.x) - 7.0, 0.0);
    let y = (mix(between[k], between[k + 1u], fract(q)) + 0.6 * behind) * sign(place.x);
    let x = 33.0 - 0.0026 * abs(y * y * y) - 16.0 * behind;
    let tangent = normalize(vec2f(-0.0078 * y * abs(y), 1.0));
    let row = min(place.y, 6.999);
    let j = u32(row);
    var inside = mix(inwards[j], inwards[j + 1u], fract(row));
    // Behind the teeth cheek and soft palate are one vault.
    var soft = array<f32, 8>(-34.0, -12.0, 0.0, 4.0, 6.5, 8.0, 9.5, 10.5);
    let formed = mix(heights[j], heights[j + 1u], fract(row));
    let height = mix(formed, mix(soft[j], soft[j + 1u], fract(row)), smoothstep(0.0, 0.6, behind));
    // Front teeth have an edge, back teeth a table.
    let table = mix(0.3, 1.0, smoothstep(1.5, 4.0, q));
    inside = select(inside, inside * table, row > 3.0 && row < 6.0);
    let on = vec2f(x, y) + vec2f(-tangent.y, tangent.x) * inside;
    // The open mouth: the plane of the edges rises forwards.
    let edges = 22.0 + (x + 15.0) * 0.42;
    let share = clamp((place.y - 7.0) / 3.0, 0.0, 1.0);
    let vault = 8.5 * (1.0 - (1.0 - share) * (1.0 - share));
    return vec3f(mix(on, vec2f(x - 9.0, 0.0), share), edges + height + vault);
}

@vertex
fn palate_vertex(@builtin(vertex_index) index: u32) -> Above {
    var corners = array<vec2u, 6>(vec2u(0u, 0u), vec2u(1u, 0u), vec2u(0u, 1u), vec2u(0u, 1u), vec2u(1u, 0u), vec2u(1u, 1u));
    let corner = corners[index % 6u];
    let quad = index / 6u;
    let column = quad % (2u * TEETH * COLUMNS) + corner.x;
    let row = quad / (2u * TEETH * COLUMNS) + corner.y;
    let place = vec2f(f32(column) / f32(COLUMNS) - f32(TEETH), f32(row));
    let at = upper(place);
    let along = upper(place + vec2f(0.1, 0.0)) - upper(place - vec2f(0.1, 0.0));
    let across = upper(vec2f(place.x, min(place.y + 0.5, f32(ROWS)))) - upper(vec2f(place.x, max(place.y - 0.5, 0.0)));
    var out: Above;
    out.clip = pass_.camera * vec4f(at, 1.0);
    out.at = at;
    out.normal = cross(along, across);
    out.place = place;
    return out;
}

@fragment
fn palate_pixel(in: Above) -> @location(0) vec4f {
    let to_eye = pass_.eye.xyz - in.at;
    var n = normalize(in.normal);
    n = select(n, -n, dot(n, to_eye) < 0.0);
    let row = in.place.y;
    let aside = 2.0 * fract(abs(in.place.x)) - 1.0;
    let scallop = 0.35 * aside * aside;
    let is_there = select(0.0, 1.0, abs(in.place.x) < 7.0);
    let tooth = is_there * smoothstep(3.1 + scallop, 3.25 + scallop, row) * (1.0 - smoothstep(5.75 - scallop, 5.9 - scallop, row));
    let gap = 1.0 - 0.65 * smoothstep(0.84, 1.0, abs(aside));
    // Folds behind the front teeth, and the seam of the palate.
    let folds = 0.10 * sin(1.5 * in.at.x + 0.5 * abs(in.at.y)) * smoothstep(2.0, 14.0, in.at.x) * smoothstep(7.0, 8.0, row);
    let seam = 0.10 * (1.0 - smoothstep(0.3, 1.2, abs(in.at.y))) * smoothstep(7.5, 8.5, row);
    let flesh = mix(vec3f(0.40, 0.15, 0.12), vec3f(0.46, 0.22, 0.18), smoothstep(6.0, 8.0, row)) * (1.0 + folds - seam);
    let colour = mix(flesh, vec3f(0.58, 0.50, 0.36) * gap, tooth);
    // Light comes back from the lower jaw, and some from the lamp.
    let bounced = vec3f(0.56, 0.49, 0.46) * (0.55 + 0.45 * clamp(-n.z, 0.0, 1.0));
    let lamp = 0.35 * pass_.light.w * max(dot(n, normalize(pass_.light.xyz - in.at)), 0.0);
    // The back lies in the dark.
    let depth = smoothstep(-44.0, -20.0, in.at.x);
    return vec4f(coded(develop(colour * (bounced + lamp) * mix(0.35, 1.0, depth))), 1.0);
}
