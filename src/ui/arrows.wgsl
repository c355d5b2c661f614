// Arrows by the thousand: one rectangle each, in which the distance to the arrow's outline decides the colour.

struct Screen {
    // Width and height in points, pixels per point, and nothing.
    size: vec4<f32>,
}

@group(0) @binding(0) var<uniform> screen: Screen;

struct Arrow {
    @builtin(position) clip: vec4<f32>,
    // Along the arrow from its origin, and across it, in points.
    @location(0) place: vec2<f32>,
    // Length, width, width of the rim.
    @location(1) @interpolate(flat) size: vec3<f32>,
    @location(2) @interpolate(flat) color: vec4<f32>,
    @location(3) @interpolate(flat) halo: vec4<f32>,
}

fn head_length(length: f32, width: f32) -> f32 {
    return min(3.6 * width, 0.75 * length);
}

@vertex
fn corner(
    @builtin(vertex_index) index: u32,
    @location(0) ends: vec4<f32>,
    @location(1) widths: vec2<f32>,
    @location(2) color: vec4<f32>,
    @location(3) halo: vec4<f32>,
) -> Arrow {
    let way = ends.zw - ends.xy;
    let length = length(way);
    let along = select(vec2<f32>(1.0, 0.0), way / max(length, 1e-6), length > 1e-3);
    let margin = widths.y + 1.0 / screen.size.z;
    let across = max(0.95 * widths.x, 0.42 * head_length(length, widths.x)) + margin;
    let back = 0.95 * widths.x + margin;
    let right = index == 1u || index == 2u || index == 4u;
    let low = index == 2u || index == 4u || index == 5u;
    let place = vec2<f32>(select(-back, max(length, 0.95 * widths.x) + margin, right), select(-across, across, low));
    let at = ends.xy + along * place.x + vec2<f32>(-along.y, along.x) * place.y;
    let clip = vec4<f32>(2.0 * at.x / screen.size.x - 1.0, 1.0 - 2.0 * at.y / screen.size.y, 0.0, 1.0);
    return Arrow(clip, place, vec3<f32>(length, widths), color, halo);
}

fn to_segment(p: vec2<f32>, a: vec2<f32>, b: vec2<f32>) -> f32 {
    let ab = b - a;
    let t = clamp(dot(p - a, ab) / max(dot(ab, ab), 1e-9), 0.0, 1.0);
    return distance(p, a + t * ab);
}

// How far outside the arrow a place is, in points; less than zero inside.
fn outside(place: vec2<f32>, length: f32, width: f32) -> f32 {
    let p = vec2<f32>(place.x, abs(place.y));
    let dot_edge = distance(place, vec2<f32>(0.0)) - 0.95 * width;
    if length <= 1e-3 {
        return dot_edge;
    }
    let head = head_length(length, width);
    let neck = length - head;
    let barb = 0.42 * head;
    let tail = vec2<f32>(0.0, 0.25 * width);
    let throat = vec2<f32>(neck, 0.5 * width);
    let wing = vec2<f32>(neck, max(barb, 0.5 * width));
    let tip = vec2<f32>(length, 0.0);
    var edge = min(to_segment(p, vec2<f32>(0.0), tail), to_segment(p, tail, throat));
    edge = min(edge, min(to_segment(p, throat, wing), to_segment(p, wing, tip)));
    let in_shaft = p.x >= 0.0 && p.x <= neck && p.y <= mix(tail.y, throat.y, p.x / max(neck, 1e-6));
    let in_head = p.x >= neck && p.x <= length && p.y <= wing.y * (length - p.x) / max(head, 1e-6);
    return min(select(edge, -edge, in_shaft || in_head), dot_edge);
}

fn inked(at: Arrow) -> vec4<f32> {
    let edge = outside(at.place, at.size.x, at.size.y);
    let ink = clamp(0.5 - edge * screen.size.z, 0.0, 1.0);
    let rim = clamp(0.5 - (edge - at.size.z) * screen.size.z, 0.0, 1.0) * (1.0 - ink);
    return vec4<f32>(at.color.rgb * ink + at.halo.rgb * rim, ink + rim);
}

@fragment
fn gamma(at: Arrow) -> @location(0) vec4<f32> {
    return inked(at);
}

// For windows whose colours are linear.
@fragment
fn linear(at: Arrow) -> @location(0) vec4<f32> {
    let color = inked(at);
    let straight = color.rgb / max(color.a, 1e-6);
    let low = straight / 12.92;
    let high = pow((straight + 0.055) / 1.055, vec3<f32>(2.4));
    return vec4<f32>(select(high, low, straight <= vec3<f32>(0.04045)) * color.a, color.a);
}
