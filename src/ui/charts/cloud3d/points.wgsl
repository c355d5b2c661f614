// Points as squares that face the eye, as large as the part of the scene that a pixel of a camera covers.

struct View {
    clip_from_world: mat4x4<f32>,
    // Width and height of the picture in pixels.
    size: vec2<f32>,
    // Pixels for a unit of the world at distance 1.
    magnification: f32,
    unused: f32,
    // Smallest and largest side in pixels.
    sides: vec2<f32>,
    padding: vec2<f32>,
}

@group(0) @binding(0) var<uniform> view: View;

struct Corner {
    @builtin(position) clip: vec4<f32>,
    @location(0) color: vec4<f32>,
}

@vertex
fn corner(
    @builtin(vertex_index) index: u32,
    @location(0) place: vec3<f32>,
    @location(1) side: f32,
    @location(2) color: vec4<f32>,
) -> Corner {
    let clip = view.clip_from_world * vec4<f32>(place, 1.0);
    let pixels = clamp(side * view.magnification / max(clip.w, 0.0001), view.sides.x, view.sides.y);
    let towards = vec2<f32>(f32(index & 1u), f32(index >> 1u)) - 0.5;
    return Corner(clip + vec4<f32>(towards * 2.0 * pixels / view.size * clip.w, 0.0, 0.0), color);
}

@fragment
fn shade(at: Corner) -> @location(0) vec4<f32> {
    return vec4<f32>(at.color.rgb, 1.0);
}
