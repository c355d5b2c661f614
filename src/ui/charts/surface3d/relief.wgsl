// The cost surface, lit from above, with a thin line along every column and row of displacements.

struct View {
    clip_from_world: mat4x4<f32>,
    light: vec4<f32>,
    eye: vec4<f32>,
    // Colour of the lines, and how strong they are.
    line: vec4<f32>,
    // Width of the lines in pixels.
    line_width: vec4<f32>,
}

@group(0) @binding(0) var<uniform> view: View;

struct Corner {
    @builtin(position) clip: vec4<f32>,
    @location(0) place: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) color: vec4<f32>,
    @location(3) grid: vec2<f32>,
}

@vertex
fn corner(
    @location(0) place: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) color: vec4<f32>,
    @location(3) grid: vec2<f32>,
) -> Corner {
    return Corner(view.clip_from_world * vec4<f32>(place, 1.0), place, normal, color, grid);
}

@fragment
fn shade(at: Corner) -> @location(0) vec4<f32> {
    let to_eye = normalize(view.eye.xyz - at.place);
    var normal = normalize(at.normal);
    normal = select(-normal, normal, dot(normal, to_eye) >= 0.0);
    let diffuse = max(dot(normal, view.light.xyz), 0.0);
    let glance = pow(max(dot(normal, normalize(view.light.xyz + to_eye)), 0.0), 40.0);
    var color = at.color.rgb * (0.58 + 0.46 * diffuse) + vec3<f32>(0.10 * glance);

    // Distance to the nearest whole column or row, in pixels; lines that come too close together fade.
    let per_pixel = max(fwidth(at.grid), vec2<f32>(1e-5));
    let distance = abs(fract(at.grid + 0.5) - 0.5) / per_pixel;
    let crowded = clamp(1.6 - 6.0 * max(per_pixel.x, per_pixel.y), 0.0, 1.0);
    let on_line = 1.0 - clamp(min(distance.x, distance.y) - 0.5 * view.line_width.x + 0.5, 0.0, 1.0);
    color = mix(color, view.line.rgb, on_line * crowded * view.line.a);
    return vec4<f32>(clamp(color, vec3<f32>(0.0), vec3<f32>(1.0)), 1.0);
}
