// Arrows by the thousand: one rectangle each, in which the distance to the arrow's outline decides the colour.
// Their form (DOT, REACH, HEAD and so on) is told before this text, so that it is that of every other painter.

struct View {
    // Width and height in points, pixels per point, and nothing.
    screen: vec4<f32>,
    // Where the first image pixel lies, points per pixel, and how many times their length displacements are drawn.
    place: vec4<f32>,
    // Widths of shaft and rim, and nothing.
    widths: vec4<f32>,
    color: vec4<f32>,
    halo: vec4<f32>,
}

@group(0) @binding(0) var<uniform> view: View;

struct Corner {
    @builtin(position) clip: vec4<f32>,
    // Along the arrow from its origin, and across it, in points.
    @location(0) place: vec2<f32>,
    @location(1) @interpolate(flat) length: f32,
}

// Corners of one half of the outline, the rim grown by `grow`, as places along the arrow and half widths there.
struct Outline {
    tail: vec2<f32>,
    neck: vec2<f32>,
    barb: f32,
    tip: f32,
}

fn outline(length: f32, grow: f32) -> Outline {
    let width = view.widths.x;
    let head = min(HEAD * width, HEAD_SHARE * length);
    let half = head * BARB;
    let barb = half + grow * (BARB + sqrt(1.0 + BARB * BARB));
    let neck = length - head - grow;
    let shaft = min(SHAFT * width, SHAFT_SHARE * half);
    let tail = vec2<f32>(min(neck, 0.0), TAPER * shaft + grow);
    return Outline(tail, vec2<f32>(neck, shaft + grow), barb, length + TIP * grow);
}

@vertex
fn corner(@builtin(vertex_index) index: u32, @location(0) ends: vec4<f32>) -> Corner {
    let start = view.place.xy + ends.xy * view.place.z;
    let way = (ends.zw - ends.xy) * view.place.w * view.place.z;
    let drawn = length(way);
    let moves = drawn >= REACH * view.widths.x;
    let along = select(vec2<f32>(1.0, 0.0), way / max(drawn, 1e-9), moves);
    let length = select(0.0, drawn, moves);
    let rim = outline(length, view.widths.y);
    let margin = 1.0 / view.screen.z;
    let dot = DOT * view.widths.x + view.widths.y;
    let across = max(dot, rim.barb) + margin;
    let back = max(dot, -rim.tail.x) + margin;
    let right = index == 1u || index == 2u || index == 4u;
    let low = index == 2u || index == 4u || index == 5u;
    let place = vec2<f32>(select(-back, max(rim.tip, dot) + margin, right), select(-across, across, low));
    let at = start + along * place.x + vec2<f32>(-along.y, along.x) * place.y;
    let clip = vec4<f32>(2.0 * at.x / view.screen.x - 1.0, 1.0 - 2.0 * at.y / view.screen.y, 0.0, 1.0);
    return Corner(clip, place, length);
}

fn to_segment(p: vec2<f32>, a: vec2<f32>, b: vec2<f32>) -> f32 {
    let ab = b - a;
    let t = clamp(dot(p - a, ab) / max(dot(ab, ab), 1e-9), 0.0, 1.0);
    return distance(p, a + t * ab);
}

// How far outside the arrow, or its rim, a place is, in points; less than zero inside.
fn outside(place: vec2<f32>, length: f32, grow: f32) -> f32 {
    let p = vec2<f32>(place.x, abs(place.y));
    let dot_edge = distance(place, vec2<f32>(0.0)) - DOT * view.widths.x - grow;
    if length <= 0.0 {
        return dot_edge;
    }
    let o = outline(length, grow);
    let barb = vec2<f32>(o.neck.x, o.barb);
    let tip = vec2<f32>(o.tip, 0.0);
    var edge = min(to_segment(p, vec2<f32>(o.tail.x, 0.0), o.tail), to_segment(p, o.tail, o.neck));
    edge = min(edge, min(to_segment(p, o.neck, barb), to_segment(p, barb, tip)));
    let t = clamp((p.x - o.tail.x) / max(o.neck.x - o.tail.x, 1e-6), 0.0, 1.0);
    let in_shaft = p.x >= o.tail.x && p.x <= o.neck.x && p.y <= mix(o.tail.y, o.neck.y, t);
    let in_head = p.x >= o.neck.x && p.x <= o.tip && p.y <= o.barb * (o.tip - p.x) / (o.tip - o.neck.x);
    return min(select(edge, -edge, in_shaft || in_head), dot_edge);
}

fn inked(at: Corner) -> vec4<f32> {
    let ink = clamp(0.5 - outside(at.place, at.length, 0.0) * view.screen.z, 0.0, 1.0);
    let covered = clamp(0.5 - outside(at.place, at.length, view.widths.y) * view.screen.z, 0.0, 1.0);
    let rim = covered * (1.0 - ink);
    return vec4<f32>(view.color.rgb * ink + view.halo.rgb * rim, ink + rim);
}

@fragment
fn gamma(at: Corner) -> @location(0) vec4<f32> {
    return inked(at);
}

// For windows whose colours are linear.
@fragment
fn linear(at: Corner) -> @location(0) vec4<f32> {
    let color = inked(at);
    let straight = color.rgb / max(color.a, 1e-6);
    let low = straight / 12.92;
    let high = pow((straight + 0.055) / 1.055, vec3<f32>(2.4));
    return vec4<f32>(select(high, low, straight <= vec3<f32>(0.04045)) * color.a, color.a);
}
