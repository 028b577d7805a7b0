// Draws the finished picture onto the window.

@group(0) @binding(0) var picture: texture_2d<f32>;
@group(0) @binding(1) var nearest: sampler;

struct Corner {
    @builtin(position) position: vec4<f32>,
    @location(0) at: vec2<f32>,
};

@vertex
fn corner(@builtin(vertex_index) index: u32) -> Corner {
    var out: Corner;
    let at = vec2<f32>(f32(index & 1u), f32(index >> 1u));
    out.position = vec4<f32>(at * 2.0 - 1.0, 0.0, 1.0);
    out.at = vec2<f32>(at.x, 1.0 - at.y);
    return out;
}

@fragment
fn as_is(in: Corner) -> @location(0) vec4<f32> {
    return textureSample(picture, nearest, in.at);
}

// For windows that expect linear light in place of screen values.
@fragment
fn to_linear(in: Corner) -> @location(0) vec4<f32> {
    let c = textureSample(picture, nearest, in.at);
    let low = c.rgb / 12.92;
    let high = pow((c.rgb + 0.055) / 1.055, vec3<f32>(2.4));
    return vec4<f32>(select(high, low, c.rgb <= vec3<f32>(0.04045)), c.a);
}
