// Lines of a given width in pixels, with smooth edges: each is a rectangle that faces the camera.

struct View {
    view: mat4x4<f32>,
    projection: mat4x4<f32>,
    pixels: vec2<f32>,
    radius: f32,
    unused: f32,
};
@group(0) @binding(0) var<uniform> scene: View;

struct Corner {
    @builtin(position) position: vec4<f32>,
    @location(0) across: f32,               // pixels from the middle
    @location(1) color: vec4<f32>,
    @location(2) half_width: f32,
};

@vertex
fn corner(
    @builtin(vertex_index) index: u32,
    @location(0) start: vec3<f32>,
    @location(1) half_width: f32,
    @location(2) end: vec3<f32>,
    @location(3) color: vec4<f32>,
) -> Corner {
    var a = (scene.view * vec4<f32>(start, 1.0)).xyz;
    var b = (scene.view * vec4<f32>(end, 1.0)).xyz;
    // A perspective has no place for points behind the eye: lines are cut off there.
    if scene.projection[2][3] < 0.0 {
        let near = -scene.projection[3][2] / scene.projection[2][2];
        if a.z > near && b.z < near { a = mix(a, b, (a.z - near) / (a.z - b.z)); }
        if b.z > near && a.z < near { b = mix(b, a, (b.z - near) / (b.z - a.z)); }
    }
    let p = scene.projection * vec4<f32>(a, 1.0);
    let q = scene.projection * vec4<f32>(b, 1.0);
    let along = (q.xy / q.w - p.xy / p.w) * scene.pixels;
    let direction = along / max(length(along), 1e-6);
    let side = vec2<f32>(-direction.y, direction.x) * (f32(index & 1u) * 2.0 - 1.0);
    let reach = half_width + 1.0;
    var at = p;
    if index >= 2u { at = q; }
    var out: Corner;
    out.position = at + vec4<f32>(side * reach * 2.0 / scene.pixels * at.w, 0.0, 0.0);
    out.across = (f32(index & 1u) * 2.0 - 1.0) * reach;
    out.color = color;
    out.half_width = half_width;
    return out;
}

@fragment
fn line(in: Corner) -> @location(0) vec4<f32> {
    let cover = clamp(in.half_width + 0.5 - abs(in.across), 0.0, 1.0) * in.color.a;
    return vec4<f32>(in.color.rgb * cover, cover);
}
