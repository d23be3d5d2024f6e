// The part of the standard library that is written in the language itself. It is included before every shader; only
// what a shader calls costs anything. Everything else is built in: core/lang/builtins.cpp.
#ifndef STDOSL_H
#define STDOSL_H

#define M_PI 3.1415926535897932
#define M_PI_2 1.5707963267948966
#define M_PI_4 0.7853981633974483
#define M_2_PI 0.6366197723675813
#define M_2PI 6.2831853071795865
#define M_4PI 12.566370614359173
#define M_2_SQRTPI 1.1283791670955126
#define M_E 2.7182818284590452
#define M_LN2 0.6931471805599453
#define M_LN10 2.3025850929940457
#define M_LOG2E 1.4426950408889634
#define M_LOG10E 0.4342944819032518
#define M_SQRT2 1.4142135623730950
#define M_SQRT1_2 0.7071067811865475

#define AEROSOL_FOR_EACH_TRIPLE(define) define(color) define(point) define(vector) define(normal)

// Whole numbers are divided towards zero before anything is rounded: mod(-7, 3) is -1, and mod(-7.0, 3.0) is 2.
int mod(int a, int b) { return a - b * (int)floor(a / b); }

// Geometry -------------------------------------------------------------------------------------------------------------

// Distance of q from the line segment from a to b.
float distance(point a, point b, point q) {
  vector along = b - a;
  float t = clamp(dot(q - a, along) / dot(along, along), 0.0, 1.0);
  return length(q - (a + t * along));
}

// n turned so that it faces against the direction i, judged by the reference normal.
vector faceforward(vector n, vector i, vector reference) { return dot(i, reference) > 0 ? -n : n; }
vector faceforward(vector n, vector i) { return faceforward(n, i, Ng); }

vector reflect(vector i, vector n) { return i - 2 * dot(n, i) * n; }

// Snell's law; eta is the index on the side of i divided by the other one. Zero in total internal reflection.
vector refract(vector i, vector n, float eta) {
  float cosine = dot(i, n);
  float k = 1 - eta * eta * (1 - cosine * cosine);
  return k < 0 ? vector(0) : eta * i - (eta * cosine + sqrt(k)) * n;
}

// Reflectance of a dielectric for unpolarised light (Cook and Torrance 1982, equation 17), directions of the reflected
// and the refracted ray.
void fresnel(vector i, normal n, float eta, output float kr, output float kt, output vector r, output vector t) {
  r = reflect(i, n);
  t = vector(0);
  kr = 1;
  kt = 0;
  float c = fabs(dot(i, n));
  float square = 1 / (eta * eta) - 1 + c * c;
  if (square >= 0) {
    float g = sqrt(square);
    float parallel = (c * (g + c) - 1) / (c * (g - c) + 1);
    float perpendicular = (g - c) / (g + c);
    kr = 0.5 * perpendicular * perpendicular * (1 + parallel * parallel);
    kt = (1 - kr) * eta * eta;
    t = refract(i, n, eta);
  }
}
void fresnel(vector i, normal n, float eta, output float kr, output float kt) {
  vector r, t;
  fresnel(i, n, eta, kr, kt, r, t);
}

// Turns p by an angle in radians about an axis through the origin (Rodrigues).
point rotate(point p, float angle, vector axis) {
  vector k = normalize(axis);
  float s, c;
  sincos(angle, s, c);
  return p * c + cross(k, p) * s + k * (dot(k, p) * (1 - c));
}
// The same about the line from a to b.
point rotate(point p, float angle, point a, point b) { return rotate(point(p - a), angle, vector(b - a)) + a; }

int iscameraray() { return raytype("camera"); }
int isdiffuseray() { return raytype("diffuse"); }
int isglossyray() { return raytype("glossy"); }
int isshadowray() { return raytype("shadow"); }

int getmatrix(string from, output matrix m) { return getmatrix(from, "common", m); }

// Patterns -------------------------------------------------------------------------------------------------------------

// Splines of cubic segments: a t^3 + b t^2 + c t + d between knots 1 and 2 (of bezier: 0 and 3, of hermite: 0 and 2) of
// the four that belong to a segment.
int aerosol_spline_stride(string basis) { return basis == "bezier" ? 3 : basis == "hermite" ? 2 : 1; }
int aerosol_spline_segments(string basis, int count) {
  return max((count - 4) / aerosol_spline_stride(basis) + 1, 1);
}
#define AEROSOL_SEGMENT(type)                                                                                    \
  void aerosol_spline_segment(string basis, type p, type q, type r, type s, output type a, output type b,        \
                              output type c, output type d) {                                                    \
    if (basis == "catmull-rom") {                                                                                \
      a = 0.5 * (s - p) + 1.5 * (q - r);                                                                         \
      b = p - 2.5 * q + 2 * r - 0.5 * s;                                                                         \
      c = 0.5 * (r - p);                                                                                         \
      d = q;                                                                                                     \
    } else if (basis == "bezier") {                                                                              \
      a = s - p + 3 * (q - r);                                                                                   \
      b = 3 * (p + r) - 6 * q;                                                                                   \
      c = 3 * (q - p);                                                                                           \
      d = p;                                                                                                     \
    } else if (basis == "bspline") {                                                                             \
      a = (s - p) / 6 + 0.5 * (q - r);                                                                           \
      b = 0.5 * (p + r) - q;                                                                                     \
      c = 0.5 * (r - p);                                                                                         \
      d = (p + 4 * q + r) / 6;                                                                                   \
    } else if (basis == "hermite") {                                                                             \
      a = 2 * (p - r) + q + s;                                                                                   \
      b = 3 * (r - p) - 2 * q - s;                                                                               \
      c = q;                                                                                                     \
      d = p;                                                                                                     \
    } else {                                                                                                     \
      a = 0;                                                                                                     \
      b = 0;                                                                                                     \
      c = basis == "constant" ? type(0) : type(r - q);                                                           \
      d = q;                                                                                                     \
    }                                                                                                            \
  }
#define AEROSOL_DEFINE(type)                                                                                     \
  AEROSOL_SEGMENT(type)                                                                                          \
  type spline(string basis, float x, int count, type y[]) {                                                      \
    int known = min(count, arraylength(y));                                                                      \
    if (known < 4) return y[max(known - 1, 0)];                                                                  \
    int segments = aerosol_spline_segments(basis, known);                                                        \
    float at = clamp(x, 0.0, 1.0) * segments;                                                                    \
    int segment = clamp((int)at, 0, segments - 1), first = segment * aerosol_spline_stride(basis);               \
    float t = at - segment;                                                                                      \
    type a, b, c, d;                                                                                             \
    aerosol_spline_segment(basis, y[first], y[first + 1], y[first + 2], y[first + 3], a, b, c, d);               \
    return ((a * t + b) * t + c) * t + d;                                                                        \
  }                                                                                                              \
  type spline(string basis, float x, type y[]) { return spline(basis, x, arraylength(y), y); }
AEROSOL_DEFINE(float)
AEROSOL_FOR_EACH_TRIPLE(AEROSOL_DEFINE)
#undef AEROSOL_DEFINE
#undef AEROSOL_SEGMENT

// The first segment that reaches the value is halved until it is found; one step of Newton's method gives the last
// digits and the derivative.
float splineinverse(string basis, float v, int count, float y[]) {
  int known = min(count, arraylength(y));
  if (known < 4) return 0;
  int stride = aerosol_spline_stride(basis), segments = aerosol_spline_segments(basis, known);
  int begin = stride == 1, end = known - 1 - begin;
  float turn = y[1] < y[known - 2] ? 1 : -1;
  if (v * turn <= y[begin] * turn) return 0;
  if (v * turn >= y[end] * turn) return 1;
  for (int segment = 0; segment < segments; ++segment) {
    int first = segment * stride;
    float a, b, c, d;
    aerosol_spline_segment(basis, y[first], y[first + 1], y[first + 2], y[first + 3], a, b, c, d);
    float last = basis == "constant" ? y[first + 2] : a + b + c + d;
    if ((d - v) * (last - v) <= 0) {
      float low = 0, high = 1;
      for (int i = 0; i < 24; ++i) {
        float middle = 0.5 * (low + high);
        float value = ((a * middle + b) * middle + c) * middle + d;
        if ((value - v) * (d - v) > 0) low = middle;
        else high = middle;
      }
      float t = 0.5 * (low + high);
      float error = v - (((a * t + b) * t + c) * t + d);
      t = clamp(t + error / ((3 * a * t + 2 * b) * t + c), 0.0, 1.0);
      return (segment + t) / segments;
    }
  }
  return 0;
}
float splineinverse(string basis, float v, float y[]) { return splineinverse(basis, v, arraylength(y), y); }

// Gabor noise (Lagae, Lefebvre, Drettakis and Dutre 2009, "Procedural noise using sparse Gabor convolution"; Lagae and
// Drettakis 2011 for solids). In every cell of a grid, a Poisson number of impulses with random places, directions and
// phases; a Gaussian of width 1 / a times a cosine of frequency 2 for each within reach.
//
// Over the footprint of a shading sample (Lagae and Drettakis 2011, "Filtering solid Gabor noise") the kernel's slice by
// the plane of px and py is convolved with the image of a Gaussian whose standard deviation is half a sample: its
// covariance is S = (px px' + py py') / 4. Both are Gaussians in the frequencies w as well, and so is their product. With
// K = I + 2 pi a^2 S it has the frequency K^-1 w, the weight exp(-pi (w.w - w.K^-1 w) / a^2) / sqrt(det K), and in the
// plane the width a / (det K)^(1/4), for which the paper, too, takes the mean of the two axes. K is the identity along
// the plane's normal, so that it serves in space as it is, and a frame in the plane is not needed.
struct aerosol_gabor_footprint {
  int seen;        // Is it wide enough to matter?
  vector away;     // Normal of the plane.
  vector x, y, z;  // Rows of K^-1.
  float narrow;    // 1 / sqrt(det K)
};
aerosol_gabor_footprint aerosol_gabor_footprint_of(vector px, vector py, float a) {
  aerosol_gabor_footprint result;
  vector away = cross(px, py);
  result.seen = dot(away, away) >= 1e-6;
  if (result.seen) {
    result.away = normalize(away);
    float f = M_PI_2 * a * a;
    float xx = 1 + f * (px[0] * px[0] + py[0] * py[0]), xy = f * (px[0] * px[1] + py[0] * py[1]);
    float yy = 1 + f * (px[1] * px[1] + py[1] * py[1]), yz = f * (px[1] * px[2] + py[1] * py[2]);
    float zz = 1 + f * (px[2] * px[2] + py[2] * py[2]), zx = f * (px[2] * px[0] + py[2] * py[0]);
    vector x = vector(yy * zz - yz * yz, yz * zx - xy * zz, xy * yz - yy * zx);
    vector y = vector(x[1], xx * zz - zx * zx, xy * zx - xx * yz), z = vector(x[2], y[2], xx * yy - xy * xy);
    float scale = 1 / dot(x, vector(xx, xy, zx));
    result.x = scale * x;
    result.y = scale * y;
    result.z = scale * z;
    result.narrow = sqrt(scale);
  }
  return result;
}
float aerosol_gabor_random(output int state) {
  state *= -1255789435;
  float x = state * 2.3283064365386963e-10;
  return x < 0 ? x + 1 : x;
}
float aerosol_gabor_cell(point at, int x, int y, int z, int seed, float mean, float radius, float a, int anisotropic,
                         vector direction, aerosol_gabor_footprint footprint) {
  int state = aerosol_hash(x, y, z, seed);
  if (state == 0) state = 1;
  int count = 0;
  float none = exp(-mean);
  for (float product = aerosol_gabor_random(state); product > none; product *= aerosol_gabor_random(state)) ++count;
  float sum = 0;
  for (int i = 0; i < count; ++i) {
    float pz = aerosol_gabor_random(state), py = aerosol_gabor_random(state), px = aerosol_gabor_random(state);
    vector offset = radius * (at - point(px, py, pz));
    float around = 0, height = 0;
    if (anisotropic != 1) around = M_2PI * aerosol_gabor_random(state);
    if (anisotropic == 0) height = 2 * aerosol_gabor_random(state) - 1;
    float phase = M_2PI * aerosol_gabor_random(state);
    float square = dot(offset, offset);
    // Most impulses are too far away: what their numbers mean is found out for the others alone.
    if (square < radius * radius) {
      vector omega = direction;
      if (anisotropic != 1) {
        float s, c;
        sincos(around, s, c);
        if (anisotropic == 0) {
          float wide = sqrt(1 - height * height);
          omega = vector(c * wide, s * wide, height);  // Its length is 1.
        } else {
          omega = length(direction) * vector(c, s, 0);
        }
      }
      float weight = 1, decay = a * a * square;
      if (footprint.seen) {
        vector seen = vector(dot(footprint.x, omega), dot(footprint.y, omega), dot(footprint.z, omega));
        float above = dot(footprint.away, offset);
        weight = footprint.narrow;
        decay = a * a * (above * above + weight * (square - above * above)) + dot(omega, omega - seen) / (a * a);
        omega = seen;
      }
      sum += weight * exp(-M_PI * decay) * cos(M_2PI * dot(omega, offset) + phase);
    }
  }
  return sum;
}
float aerosol_gabor(point p, int periodic, point period, int seed, int anisotropic, vector direction, float bandwidth,
                    float impulses, vector px, vector py) {
  float octaves = exp2(clamp(bandwidth, 0.01, 100.0));
  float a = 2 * ((octaves - 1) / (octaves + 1)) * sqrt(M_PI / M_LN2);
  float radius = sqrt(-log(0.02) / M_PI) / a;
  float mean = clamp(impulses, 1.0, 32.0) / (4 * M_PI / 3);
  aerosol_gabor_footprint footprint = aerosol_gabor_footprint_of(px, py, a);
  point grid = p / radius;
  point cell = floor(grid), within = grid - cell;
  float sum = 0;
  for (int k = -1; k <= 1; ++k) {
    for (int j = -1; j <= 1; ++j) {
      for (int i = -1; i <= 1; ++i) {
        point place = cell + vector(i, j, k);
        if (periodic) place = mod(place, max(floor(period), point(1)));
        sum += aerosol_gabor_cell(within - vector(i, j, k), (int)place[0], (int)place[1], (int)place[2], seed, mean,
                                  radius, a, anisotropic, direction, footprint);
      }
    }
  }
  // The sum's standard deviation is known; half of its three-sigma range is the unit.
  float density = mean / (radius * radius * radius), variance = 1 / (4 * M_SQRT2 * a * a * a);
  return sum / sqrt(density) * (0.5 / (3 * sqrt(variance)));
}
vector aerosol_gabor_triple(point p, int periodic, point period, int anisotropic, vector direction, float bandwidth,
                            float impulses, vector px, vector py) {
  return vector(aerosol_gabor(p, periodic, period, 0, anisotropic, direction, bandwidth, impulses, px, py),
                aerosol_gabor(p, periodic, period, 1, anisotropic, direction, bandwidth, impulses, px, py),
                aerosol_gabor(p, periodic, period, 2, anisotropic, direction, bandwidth, impulses, px, py));
}

// A linear ramp from 0 at low to 1 at high, whose corners are rounded by parabolas over a distance of eps.
float smooth_linearstep(float low, float high, float x, float eps) {
  if (low == high) return step(low, x);
  float scale = 1 / (high - low);
  float t = (x - low) * scale, e = eps * scale;
  float rise = clamp(t + e, 0.0, 2 * e), fall = clamp(1 + e - t, 0.0, 2 * e);
  if (t < e) return rise * rise / (4 * e);
  if (t > 1 - e) return 1 - fall * fall / (4 * e);
  return t;
}
#define AEROSOL_DEFINE(type)                                              \
  type smooth_linearstep(type low, type high, type x, type eps) {         \
    return type(smooth_linearstep(low[0], high[0], x[0], eps[0]),         \
                smooth_linearstep(low[1], high[1], x[1], eps[1]),         \
                smooth_linearstep(low[2], high[2], x[2], eps[2]));        \
  }
AEROSOL_FOR_EACH_TRIPLE(AEROSOL_DEFINE)
#undef AEROSOL_DEFINE

// A step at edge, filtered by a box as wide as s and edge change between shading samples.
float aastep(float edge, float s, float dedge, float ds) {
  float width = fabs(dedge) + fabs(ds);
  float low = edge - 0.5 * width;
  return s <= low ? 0.0 : s >= edge + 0.5 * width ? 1.0 : (s - low) / width;
}
float aastep(float edge, float s, float ds) { return aastep(edge, s, filterwidth(edge), ds); }
float aastep(float edge, float s) { return aastep(edge, s, filterwidth(edge), filterwidth(s)); }

closure color mix(closure color x, closure color y, float a) { return x * (1 - a) + y * a; }
closure color mix(closure color x, closure color y, color a) { return x * (1 - a) + y * a; }

// Displacement ---------------------------------------------------------------------------------------------------------

// Moves the surface, which then faces where its neighbouring points say. A space names the unit of amounts; normals
// are longer where units of that space are.
void displace(vector offset) {
  P += offset;
  N = normalize(calculatenormal(P));
}
void displace(float amount) { displace(amount * N); }
void displace(string space, float amount) { displace(amount * length(transform(space, N)) * N); }
void displace(string space, vector offset) { displace(transform(space, "common", offset)); }

// The normal alone, as if the surface had been moved.
void bump(vector offset) { N = normalize(calculatenormal(P + offset)); }
void bump(float amount) { bump(amount * N); }
void bump(string space, float amount) { bump(amount * length(transform(space, N)) * N); }
void bump(string space, vector offset) { bump(transform(space, "common", offset)); }

// Colours --------------------------------------------------------------------------------------------------------------

float luminance(color c) { return 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2]; }

// Hue, saturation and value. Hue runs from 0 to 1 around the circle.
color aerosol_hsv_from_rgb(color c) {
  float high = max(max(c[0], c[1]), c[2]), low = min(min(c[0], c[1]), c[2]);
  float chroma = high - low;
  float sector = c[0] == high ? (c[1] - c[2]) / chroma
                              : c[1] == high ? 2 + (c[2] - c[0]) / chroma : 4 + (c[0] - c[1]) / chroma;
  return color(chroma > 0 ? mod(sector / 6, 1.0) : 0.0, chroma / high, high);
}
float aerosol_hsv_channel(color hsv, float sector) {
  float k = mod(sector + 6 * hsv[0], 6.0);
  return hsv[2] - hsv[2] * hsv[1] * clamp(min(k, 4 - k), 0.0, 1.0);
}
color aerosol_rgb_from_hsv(color c) {
  return color(aerosol_hsv_channel(c, 5), aerosol_hsv_channel(c, 3), aerosol_hsv_channel(c, 1));
}
color aerosol_hsl_from_rgb(color c) {
  color hsv = aerosol_hsv_from_rgb(c);
  float lightness = hsv[2] * (1 - 0.5 * hsv[1]);
  return color(hsv[0], (hsv[2] - lightness) / min(lightness, 1 - lightness), lightness);
}
color aerosol_rgb_from_hsl(color c) {
  float value = c[2] + c[1] * min(c[2], 1 - c[2]);
  return aerosol_rgb_from_hsv(color(c[0], 2 * (1 - c[2] / value), value));
}
color aerosol_yiq_from_rgb(color c) {
  return color(dot(vector(0.299, 0.587, 0.114), vector(c)), dot(vector(0.596, -0.275, -0.321), vector(c)),
               dot(vector(0.212, -0.523, 0.311), vector(c)));
}
color aerosol_rgb_from_yiq(color c) {
  return color(c[0] + 0.9557 * c[1] + 0.6199 * c[2], c[0] - 0.2716 * c[1] - 0.6469 * c[2],
               c[0] - 1.1082 * c[1] + 1.7051 * c[2]);
}
// Primaries of Rec. 709 and white D65.
color aerosol_xyz_from_rgb(color c) {
  return color(dot(vector(0.4123908, 0.3575843, 0.1804808), vector(c)),
               dot(vector(0.2126390, 0.7151687, 0.0721923), vector(c)),
               dot(vector(0.0193308, 0.1191948, 0.9505322), vector(c)));
}
color aerosol_rgb_from_xyz(color c) {
  return color(dot(vector(3.2409699, -1.5373832, -0.4986108), vector(c)),
               dot(vector(-0.9692436, 1.8759675, 0.0415551), vector(c)),
               dot(vector(0.0556301, -0.2039770, 1.0569715), vector(c)));
}
color aerosol_xyy_from_xyz(color c) {
  float sum = c[0] + c[1] + c[2];
  return color(c[0] / sum, c[1] / sum, c[1]);
}
color aerosol_xyz_from_xyy(color c) {
  float scale = c[2] / c[1];
  return color(scale * c[0], c[2], scale * (1 - c[0] - c[1]));
}


// The standard's encoding of linear values (IEC 61966-2-1).
float aerosol_srgb_encoded(float x) { return x <= 0.0031308 ? 12.92 * x : 1.055 * pow(x, 1 / 2.4) - 0.055; }
float aerosol_srgb_decoded(float x) { return x <= 0.04045 ? x / 12.92 : pow((x + 0.055) / 1.055, 2.4); }
color aerosol_srgb_from_rgb(color c) {
  return color(aerosol_srgb_encoded(c[0]), aerosol_srgb_encoded(c[1]), aerosol_srgb_encoded(c[2]));
}
color aerosol_rgb_from_srgb(color c) {
  return color(aerosol_srgb_decoded(c[0]), aerosol_srgb_decoded(c[1]), aerosol_srgb_decoded(c[2]));
}

// Names of the linear space in which colours are: primaries of Rec. 709.
int aerosol_is_rgb(string space) {
  return space == "rgb" || space == "RGB" || space == "linear" || space == "Rec709" || space == "HDTV";
}

// Between "rgb" (also "RGB", "linear", "Rec709", "HDTV"), "sRGB", "hsv", "hsl", "YIQ", "XYZ" and "xyY", and whatever the
// colour configuration knows.
color transformc(string from, string to, color c) {
  color rgb = c;
  if (from == to) return c;
  if (from == "hsv") rgb = aerosol_rgb_from_hsv(c);
  else if (from == "hsl") rgb = aerosol_rgb_from_hsl(c);
  else if (from == "YIQ") rgb = aerosol_rgb_from_yiq(c);
  else if (from == "XYZ") rgb = aerosol_rgb_from_xyz(c);
  else if (from == "xyY") rgb = aerosol_rgb_from_xyz(aerosol_xyz_from_xyy(c));
  else if (from == "sRGB") rgb = aerosol_rgb_from_srgb(c);
  else if (!aerosol_is_rgb(from)) rgb = aerosol_colors(from, "rgb", c);
  if (to == "hsv") return aerosol_hsv_from_rgb(rgb);
  if (to == "hsl") return aerosol_hsl_from_rgb(rgb);
  if (to == "YIQ") return aerosol_yiq_from_rgb(rgb);
  if (to == "XYZ") return aerosol_xyz_from_rgb(rgb);
  if (to == "xyY") return aerosol_xyy_from_xyz(aerosol_xyz_from_rgb(rgb));
  if (to == "sRGB") return aerosol_srgb_from_rgb(rgb);
  return aerosol_is_rgb(to) ? rgb : aerosol_colors("rgb", to, rgb);
}
color transformc(string to, color c) { return transformc("rgb", to, c); }

// The CIE 1931 standard observer's matching functions (x, y, z), every 5 nm from 380 to 780 nm.
#define AEROSOL_OBSERVER                                                                                     \
  {                                                                                                          \
    {0.0014, 0, 0.0065}, {0.0022, 0.0001, 0.0105}, {0.0042, 0.0001, 0.0201}, {0.0076, 0.0002, 0.0362},       \
    {0.0143, 0.0004, 0.0679}, {0.0232, 0.0006, 0.1102}, {0.0435, 0.0012, 0.2074}, {0.0776, 0.0022, 0.3713},  \
    {0.1344, 0.004, 0.6456}, {0.2148, 0.0073, 1.0391}, {0.2839, 0.0116, 1.3856}, {0.3285, 0.0168, 1.623},    \
    {0.3483, 0.023, 1.7471}, {0.3481, 0.0298, 1.7826}, {0.3362, 0.038, 1.7721}, {0.3187, 0.048, 1.7441},     \
    {0.2908, 0.06, 1.6692}, {0.2511, 0.0739, 1.5281}, {0.1954, 0.091, 1.2876}, {0.1421, 0.1126, 1.0419},     \
    {0.0956, 0.139, 0.813}, {0.058, 0.1693, 0.6162}, {0.032, 0.208, 0.4652}, {0.0147, 0.2586, 0.3533},       \
    {0.0049, 0.323, 0.272}, {0.0024, 0.4073, 0.2123}, {0.0093, 0.503, 0.1582}, {0.0291, 0.6082, 0.1117},     \
    {0.0633, 0.71, 0.0782}, {0.1096, 0.7932, 0.0573}, {0.1655, 0.862, 0.0422}, {0.2257, 0.9149, 0.0298},     \
    {0.2904, 0.954, 0.0203}, {0.3597, 0.9803, 0.0134}, {0.4334, 0.995, 0.0087}, {0.5121, 1, 0.0057},         \
    {0.5945, 0.995, 0.0039}, {0.6784, 0.9786, 0.0027}, {0.7621, 0.952, 0.0021}, {0.8425, 0.9154, 0.0018},    \
    {0.9163, 0.87, 0.0017}, {0.9786, 0.8163, 0.0014}, {1.0263, 0.757, 0.0011}, {1.0567, 0.6949, 0.001},      \
    {1.0622, 0.631, 0.0008}, {1.0456, 0.5668, 0.0006}, {1.0026, 0.503, 0.0003}, {0.9384, 0.4412, 0.0002},    \
    {0.8544, 0.381, 0.0002}, {0.7514, 0.321, 0.0001}, {0.6424, 0.265, 0}, {0.5419, 0.217, 0},                \
    {0.4479, 0.175, 0}, {0.3608, 0.1382, 0}, {0.2835, 0.107, 0}, {0.2187, 0.0816, 0}, {0.1649, 0.061, 0},    \
    {0.1212, 0.0446, 0}, {0.0874, 0.032, 0}, {0.0636, 0.0232, 0}, {0.0468, 0.017, 0}, {0.0329, 0.0119, 0},   \
    {0.0227, 0.0082, 0}, {0.0158, 0.0057, 0}, {0.0114, 0.0041, 0}, {0.0081, 0.0029, 0}, {0.0058, 0.0021, 0}, \
    {0.0041, 0.0015, 0}, {0.0029, 0.001, 0}, {0.002, 0.0007, 0}, {0.0014, 0.0005, 0}, {0.001, 0.0004, 0},    \
    {0.0007, 0.0002, 0}, {0.0005, 0.0002, 0}, {0.0003, 0.0001, 0}, {0.0002, 0.0001, 0}, {0.0002, 0.0001, 0}, \
    {0.0001, 0, 0}, {0.0001, 0, 0}, {0.0001, 0, 0}, {0, 0, 0}                                                \
  }

// Exitance of a black body in W / m^2 as colour: Planck's law, 2 pi h c^2 / (w^5 (exp(h c / (w k T)) - 1)), summed over
// the visible wavelengths w. The sum runs in units of 1e-7 m, so that no float overflows.
color blackbody(float temperatureK) {
  color observer[81] = AEROSOL_OBSERVER;
  color xyz = 0;
  for (int i = 0; i < 81; ++i) {
    float w = 3.8 + 0.05 * i;
    xyz += observer[i] / (w * w * w * w * w * expm1(min(143877.69 / (w * max(temperatureK, 1.0)), 87.0)));
  }
  return max(aerosol_rgb_from_xyz(xyz * (3.7417719e-16 * 1e35 * 5e-9)), color(0));
}

// Colour of monochromatic light, scaled so that no component is above 1.
color wavelength_color(float wavelength_nm) {
  color observer[81] = AEROSOL_OBSERVER;
  float at = (wavelength_nm - 380) / 5;
  if (at < 0 || at >= 80) return 0;
  int i = (int)at;
  return max(aerosol_rgb_from_xyz(mix(observer[i], observer[i + 1], at - i)) / 2.52, color(0));
}
#undef AEROSOL_OBSERVER

// Closures -------------------------------------------------------------------------------------------------------------

closure color reflection(normal n) { return reflection(n, 0.0); }
closure color translucent() { return translucent(N); }
closure color microfacet(string distribution, normal n, float alpha, float eta, int refract) {
  return microfacet(distribution, n, vector(0), alpha, alpha, eta, refract);
}
// Names of before `microfacet`; without an index there is no Fresnel term.
closure color microfacet_ggx(normal n, float alpha, float eta) { return microfacet("ggx", n, alpha, eta, 0); }
closure color microfacet_ggx(normal n, float alpha) { return microfacet_ggx(n, alpha, 0.0); }
closure color microfacet_ggx_refraction(normal n, float alpha, float eta) {
  return microfacet("ggx", n, alpha, eta, 1);
}
closure color microfacet_beckmann(normal n, float alpha, float eta) {
  return microfacet("beckmann", n, alpha, eta, 0);
}
closure color microfacet_beckmann(normal n, float alpha) { return microfacet_beckmann(n, alpha, 0.0); }
closure color microfacet_beckmann_refraction(normal n, float alpha, float eta) {
  return microfacet("beckmann", n, alpha, eta, 1);
}

// Complex index of refraction of a metal from its colour at facing and towards grazing angles (Gulbrandsen 2014,
// "Artist friendly metallic Fresnel").
void artistic_ior(color reflectivity, color edge_tint, output color ior, output color extinction) {
  color r = clamp(reflectivity, color(0), color(0.99)), root = sqrt(r);
  ior = mix((1 + root) / (1 - root), (1 - r) / (1 + r), edge_tint);
  color above = ior + 1, below = ior - 1;
  extinction = sqrt(max((r * above * above - below * below) / (1 - r), color(0)));
}

#endif
