// Draws particles as squares that face the camera: discs with smooth edges in 2D, shaded balls in 3D.
// A square is two triangles with six corners. The particles are in textures, see texels.rs.

struct View {
    view: mat4x4<f32>,        // scene, relative to the origin, to the camera's axes
    projection: mat4x4<f32>,
    pixels: vec2<f32>,        // width and height of the picture
    radius: f32,              // radius of a particle, in parts of its spacing
    unused: f32,
};
@group(0) @binding(0) var<uniform> scene: View;
@group(0) @binding(1) var places: texture_2d<f32>;      // position, spacing
@group(0) @binding(2) var colors: texture_2d<f32>;

const WIDTH: u32 = 2048u;                               // particles in a row

struct Corner {
    @builtin(position) position: vec4<f32>,
    @location(0) at: vec2<f32>,             // -1..1 over the disc
    @location(1) color: vec4<f32>,
    @location(2) center: vec3<f32>,         // on the camera's axes
    @location(3) radius: f32,
};

@vertex
fn corner(@builtin(vertex_index) index: u32) -> Corner {
    let particle = index / 6u;
    let texel = vec2<u32>(particle % WIDTH, particle / WIDTH);
    let place = textureLoad(places, texel, 0);
    let position = place.xyz;
    let spacing = place.w;
    // Corners 0 1 2, 2 1 3 of
    //     2 3
    //     0 1
    let k = index % 6u;
    let which = select(k, select(5u - k, 3u, k == 5u), k > 2u);
    var out: Corner;
    let center = (scene.view * vec4<f32>(position, 1.0)).xyz;
    // A particle is never much smaller than a pixel: a far one should fade, not flicker.
    let w = scene.projection[2][3] * center.z + scene.projection[3][3];
    let pixel = 2.0 * w / (scene.projection[1][1] * scene.pixels.y);
    let radius = max(scene.radius * spacing, 0.7 * pixel);
    let at = vec2<f32>(f32(which & 1u), f32(which >> 1u)) * 2.0 - 1.0;
    // The square is larger than the disc by half a pixel, for the soft edge.
    let reach = 1.0 + 0.5 * pixel / radius;
    out.at = at * reach;
    out.position = scene.projection * vec4<f32>(center + vec3<f32>(out.at * radius, 0.0), 1.0);
    out.color = textureLoad(colors, texel, 0);
    out.center = center;
    out.radius = radius;
    return out;
}

@fragment
fn disc(in: Corner) -> @location(0) vec4<f32> {
    let r = length(in.at);
    let soft = fwidth(r);
    let cover = clamp((1.0 - r) / max(soft, 1e-6) + 0.5, 0.0, 1.0);
    return vec4<f32>(in.color.rgb * cover, cover);
}

struct Ball {
    @location(0) color: vec4<f32>,
    @builtin(frag_depth) depth: f32,
};

@fragment
fn ball(in: Corner) -> Ball {
    let r2 = dot(in.at, in.at);
    if r2 > 1.0 {
        discard;
    }
    let normal = vec3<f32>(in.at, sqrt(1.0 - r2));
    let light = normalize(vec3<f32>(-0.45, 0.75, 0.6));
    let shade = 0.42 + 0.58 * max(dot(normal, light), 0.0);
    // Upward faces take a little of the sky.
    let sky = 0.10 * max(normal.y, 0.0);
    let z = in.center.z + normal.z * in.radius;
    let clip = scene.projection * vec4<f32>(0.0, 0.0, z, 1.0);
    var out: Ball;
    out.color = vec4<f32>(in.color.rgb * shade + vec3<f32>(sky), 1.0);
    out.depth = clip.z / clip.w;
    return out;
}
