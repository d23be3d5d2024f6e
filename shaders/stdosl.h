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
    float at = min(max(0.0, x), 1.0) * segments; /* In this order the ends have slopes. */                       \
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
  float beyond = 0;
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
    // A value that no segment reaches is at the nearer end of the last one.
    beyond = (v > max(d, last)) == (d < last) ? 1.0 : (segments - 1.0) / segments;
  }
  return beyond;
}
float splineinverse(string basis, float v, float y[]) { return splineinverse(basis, v, arraylength(y), y); }

// Gabor noise (Lagae, Lefebvre, Drettakis and Dutre 2009, "Procedural noise using sparse Gabor convolution"; Lagae and
// Drettakis 2011 for solids). In every cell of a grid, a Poisson number of impulses with random places, directions and
// phases; a Gaussian of width 1 / a times a cosine of frequency 2 for each within reach.
//
// Over the footprint of a shading sample (Lagae and Drettakis 2011, "Filtering solid Gabor noise") the kernel's slice by
// the plane of px and py is convolved with a Gaussian of covariance S. It would be (px px' + py py') / 4, the image of a
// standard deviation of half a sample; the language's implementation has the matrix of px and py the other way round,
// and what is to look alike has to follow: S = (p p' + q q') / 4, where p and q are (px_0, py_0, 0) and (px_1, py_1, 0)
// without what they have across the plane. Both are Gaussians in the frequencies w as well, and so is their product. With
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
  vector n = normalize(away), p = vector(px[0], py[0], 0), q = vector(px[1], py[1], 0);
  p -= dot(p, n) * n;
  q -= dot(q, n) * n;
  vector product = cross(p, q);
  result.seen = dot(away, away) >= 1e-6 && dot(product, product) >= 1.6e-17;
  if (result.seen) {
    result.away = n;
    float f = M_PI_2 * a * a;
    float xx = 1 + f * (p[0] * p[0] + q[0] * q[0]), xy = f * (p[0] * p[1] + q[0] * q[1]);
    float yy = 1 + f * (p[1] * p[1] + q[1] * q[1]), yz = f * (p[1] * p[2] + q[1] * q[2]);
    float zz = 1 + f * (p[2] * p[2] + q[2] * q[2]), zx = f * (p[2] * p[0] + q[2] * q[0]);
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
  if (t <= -e) return 0;
  if (t >= e && t <= 1 - e) return t;
  if (t >= 1 + e) return 1;
  return t < e ? (t + e) * (t + e) / (4 * e) : 1 - (1 + e - t) * (1 + e - t) / (4 * e);
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

float luminance(color c) { return 0.21250724 * c[0] + 0.71535000 * c[1] + 0.07214272 * c[2]; }

// Hue, saturation and value. Hue runs from 0 to 1 around the circle.
color aerosol_hsv_from_rgb(color c) {
  float high = max(max(c[0], c[1]), c[2]), low = min(min(c[0], c[1]), c[2]);
  float chroma = high - low;
  if (high <= 0 || chroma == 0) return color(0, 0, high);
  float sector = c[0] == high ? (c[1] - c[2]) / chroma
                              : c[1] == high ? 2 + (c[2] - c[0]) / chroma : 4 + (c[0] - c[1]) / chroma;
  return color(sector < 0 ? sector / 6 + 1 : sector / 6, chroma / high, high);
}
color aerosol_rgb_from_hsv(color c) {
  if (c[1] < 0.0001) return color(c[2]);
  float hue = 6 * (c[0] - floor(c[0])), sector = floor(hue), f = hue - sector;
  float p = c[2] * (1 - c[1]), q = c[2] * (1 - c[1] * f), t = c[2] * (1 - c[1] * (1 - f));
  if (sector == 0) return color(c[2], t, p);
  if (sector == 1) return color(q, c[2], p);
  if (sector == 2) return color(p, c[2], t);
  if (sector == 3) return color(p, q, c[2]);
  if (sector == 4) return color(t, p, c[2]);
  return color(c[2], p, q);
}
// Hue, saturation and lightness.
color aerosol_hsl_from_rgb(color c) {
  float high = max(max(c[0], c[1]), c[2]), low = min(min(c[0], c[1]), c[2]), lightness = 0.5 * (high + low);
  float chroma = high - low;
  return color(aerosol_hsv_from_rgb(c)[0], chroma / (lightness < 0.5 ? high + low : 2 - high - low), lightness);
}
color aerosol_rgb_from_hsl(color c) {
  float value = c[2] <= 0.5 ? c[2] * (1 + c[1]) : c[2] * (1 - c[1]) + c[1];
  return value <= 0 ? color(0) : aerosol_rgb_from_hsv(color(c[0], 2 * (value - c[2]) / value, value));
}
color aerosol_yiq_from_rgb(color c) {
  return color(dot(vector(0.299, 0.587, 0.114), vector(c)), dot(vector(0.596, -0.275, -0.321), vector(c)),
               dot(vector(0.212, -0.523, 0.311), vector(c)));
}
color aerosol_rgb_from_yiq(color c) {
  return color(c[0] + 0.9557 * c[1] + 0.6199 * c[2], c[0] - 0.2716 * c[1] - 0.6469 * c[2],
               c[0] - 1.1082 * c[1] + 1.7051 * c[2]);
}
// Primaries of Rec. 709; of D65 the language has the chromaticity (0.3127, 0.3291), by which its tables differ in the
// fourth digit from those of white (0.3127, 0.3290).
color aerosol_xyz_from_rgb(color c) {
  return color(dot(vector(0.41213532, 0.35767500, 0.18035680), vector(c)),
               dot(vector(0.21250728, 0.71535001, 0.07214272), vector(c)),
               dot(vector(0.01931884, 0.11922500, 0.94987913), vector(c)));
}
color aerosol_rgb_from_xyz(color c) {
  return color(dot(vector(3.24297897, -1.53833618, -0.49891984), vector(c)),
               dot(vector(-0.96899795, 1.87549198, 0.04154452), vector(c)),
               dot(vector(0.05566832, -0.20411719, 1.05769816), vector(c)));
}
color aerosol_xyy_from_xyz(color c) {
  float sum = c[0] + c[1] + c[2], scale = sum > 1e-6 ? 1 / sum : 0;
  return color(c[0] * scale, c[1] * scale, c[1]);
}
color aerosol_xyz_from_xyy(color c) {
  float scale = c[1] > 1e-6 ? c[2] / c[1] : 0;
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
// the visible wavelengths w. The sum runs in units of 1e-7 m, so that no float overflows. The constants are the
// language's, of an older measurement than today's.
color aerosol_blackbody(float temperatureK) {
  color observer[81] = AEROSOL_OBSERVER;
  color xyz = 0;
  for (int i = 0; i < 81; ++i) {
    float w = 3.8 + 0.05 * i;
    xyz += observer[i] / (w * w * w * w * w * expm1(min(143880.0 / (w * temperatureK), 87.0)));
  }
  return max(aerosol_rgb_from_xyz(xyz * (3.74183e-16 * 1e35 * 5e-9)), color(0));
}

// Its fifth root at 800 K + 2 K i^1.5. Up to 12,000 K the language gives what lies between these by lines.
#define AEROSOL_BLACKBODY                                                                                    \
  {                                                                                                          \
    {0.1822424, 0, 0}, {0.1848091, 0, 0}, {0.1895632, 0, 0}, {0.1958372, 0, 0}, {0.2034398, 0, 0},           \
    {0.2122921, 0, 0}, {0.2223657, 0, 0}, {0.233661, 0, 0}, {0.2461967, 0, 0}, {0.2600039, 0, 0},            \
    {0.2751232, 0, 0}, {0.2916023, 0, 0}, {0.3094943, 0, 0}, {0.3288568, 0, 0}, {0.3497509, 0, 0},           \
    {0.3722405, 0, 0}, {0.3963917, 0, 0}, {0.4222722, 0, 0}, {0.4499509, 0, 0},                              \
    {0.4794973, 0.09449854, 0}, {0.5109811, 0.1642834, 0}, {0.5444721, 0.1998748, 0},                        \
    {0.5800392, 0.2308737, 0}, {0.6177508, 0.260775, 0}, {0.6576738, 0.2908248, 0},                          \
    {0.6998735, 0.3216396, 0}, {0.7444136, 0.3535871, 0}, {0.7913554, 0.386916, 0},                          \
    {0.8407578, 0.421811, 0}, {0.892677, 0.4584183, 0}, {0.9471663, 0.4968597, 0},                           \
    {1.004276, 0.5372403, 0}, {1.064052, 0.579653, 0}, {1.126539, 0.6241812, 0},                             \
    {1.191775, 0.6709009, 0}, {1.259798, 0.7198817, 0}, {1.330637, 0.7711875, 0},                            \
    {1.404322, 0.8248773, 0}, {1.480877, 0.8810051, 0}, {1.56032, 0.9396209, 0}, {1.642668, 1.00077, 0},     \
    {1.727932, 1.064493, 0}, {1.81612, 1.130828, 0}, {1.907235, 1.199808, 0}, {2.001275, 1.271461, 0},       \
    {2.098237, 1.345813, 0}, {2.198112, 1.422885, 0}, {2.300888, 1.502696, 0}, {2.406547, 1.585257, 0},      \
    {2.515072, 1.67058, 0}, {2.626437, 1.758671, 0}, {2.740618, 1.849533, 0}, {2.857584, 1.943165, 0},       \
    {2.977302, 2.039564, 0}, {3.099737, 2.138721, 0}, {3.22485, 2.240627, 0}, {3.3526, 2.345267, 0},         \
    {3.482943, 2.452626, 0}, {3.615835, 2.562683, 0}, {3.751226, 2.675417, 0}, {3.889067, 2.790802, 0},      \
    {4.029306, 2.908811, 0}, {4.171889, 3.029415, 0}, {4.316762, 3.152581, 0}, {4.463868, 3.278275, 0},      \
    {4.61315, 3.40646, 0}, {4.764549, 3.537099, 0}, {4.918006, 3.670152, 0},                                 \
    {5.07346, 3.805576, 1.400112}, {5.23085, 3.943329, 1.694571}, {5.390115, 4.083365, 1.912993},            \
    {5.551193, 4.22564, 2.102318}, {5.714021, 4.370106, 2.276973}, {5.878537, 4.516714, 2.443367},           \
    {6.044679, 4.665417, 2.604907}, {6.212384, 4.816162, 2.763615}, {6.381589, 4.968901, 2.920783},          \
    {6.552233, 5.123581, 3.077279}, {6.724253, 5.280151, 3.23371}, {6.897589, 5.438558, 3.390512},           \
    {7.072178, 5.598749, 3.548004}, {7.247961, 5.760671, 3.706423}, {7.424877, 5.924272, 3.865947},          \
    {7.602867, 6.089497, 4.026709}, {7.781873, 6.256293, 4.188809}, {7.961837, 6.424607, 4.35232},           \
    {8.142701, 6.594385, 4.517296}, {8.324409, 6.765575, 4.683774}, {8.506906, 6.938123, 4.851777},          \
    {8.690138, 7.111976, 5.021319}, {8.874051, 7.287083, 5.192403}, {9.058593, 7.463392, 5.365027},          \
    {9.243711, 7.64085, 5.539182}, {9.429357, 7.819407, 5.714854}, {9.61548, 7.999013, 5.892025},            \
    {9.802031, 8.179617, 6.070672}, {9.988965, 8.361169, 6.25077}, {10.17623, 8.543623, 6.432293},           \
    {10.36379, 8.726928, 6.61521}, {10.5516, 8.911038, 6.799489}, {10.73961, 9.095906, 6.985098},            \
    {10.92778, 9.281486, 7.172002}, {11.11607, 9.467732, 7.360165}, {11.30445, 9.654601, 7.549551},          \
    {11.49287, 9.842049, 7.740124}, {11.68129, 10.03003, 7.931844}, {11.86968, 10.21851, 8.124675},          \
    {12.05801, 10.40744, 8.318577}, {12.24624, 10.59678, 8.513512}, {12.43433, 10.78649, 8.709441},          \
    {12.62226, 10.97654, 8.906325}, {12.81, 11.16688, 9.104125}, {12.99751, 11.35748, 9.302803},             \
    {13.18476, 11.5483, 9.502319}, {13.37173, 11.73931, 9.702636}, {13.55839, 11.93047, 9.903715},           \
    {13.74472, 12.12175, 10.10552}, {13.93068, 12.31312, 10.30801}, {14.11627, 12.50454, 10.51115},          \
    {14.30144, 12.69598, 10.7149}, {14.48618, 12.88742, 10.91923}, {14.67047, 13.07881, 11.1241},            \
    {14.85429, 13.27014, 11.32948}, {15.03762, 13.46138, 11.53532}, {15.22043, 13.65249, 11.74161},          \
    {15.40272, 13.84346, 11.94829}, {15.58446, 14.03425, 12.15535}, {15.76564, 14.22485, 12.36274},          \
    {15.94623, 14.41522, 12.57043}, {16.12624, 14.60535, 12.7784}, {16.30563, 14.79521, 12.98661},           \
    {16.48441, 14.98477, 13.19503}, {16.66255, 15.17403, 13.40364}, {16.84004, 15.36296, 13.61239},          \
    {17.01688, 15.55153, 13.82128}, {17.19304, 15.73974, 14.03025}, {17.36853, 15.92755, 14.2393},           \
    {17.54332, 16.11496, 14.44839}, {17.71741, 16.30194, 14.65749}, {17.8908, 16.48849, 14.86658},           \
    {18.06347, 16.67458, 15.07564}, {18.23542, 16.86019, 15.28464}, {18.40663, 17.04532, 15.49356},          \
    {18.57711, 17.22995, 15.70237}, {18.74684, 17.41407, 15.91106}, {18.91583, 17.59765, 16.11959},          \
    {19.08406, 17.7807, 16.32795}, {19.25152, 17.9632, 16.53612}, {19.41823, 18.14513, 16.74408},            \
    {19.58416, 18.32649, 16.9518}, {19.74933, 18.50727, 17.15927}, {19.91372, 18.68745, 17.36647},           \
    {20.07733, 18.86703, 17.57338}, {20.24016, 19.04599, 17.77999}, {20.40221, 19.22434, 17.98627},          \
    {20.56347, 19.40205, 18.19221}, {20.72395, 19.57913, 18.3978}, {20.88363, 19.75556, 18.60301},           \
    {21.04253, 19.93134, 18.80784}, {21.20064, 20.10646, 19.01226}, {21.35797, 20.28092, 19.21627},          \
    {21.5145, 20.45471, 19.41986}, {21.67024, 20.62782, 19.623}, {21.82519, 20.80026, 19.82568},             \
    {21.97935, 20.972, 20.0279}, {22.13272, 21.14306, 20.22963}, {22.28531, 21.31342, 20.43088},             \
    {22.43711, 21.48309, 20.63162}, {22.58813, 21.65205, 20.83186}, {22.73836, 21.82031, 21.03156},          \
    {22.88781, 21.98786, 21.23074}, {23.03648, 22.1547, 21.42937}, {23.18438, 22.32083, 21.62746},           \
    {23.3315, 22.48624, 21.82498}, {23.47784, 22.65094, 22.02193}, {23.62342, 22.81492, 22.21831},           \
    {23.76822, 22.97817, 22.4141}, {23.91227, 23.14071, 22.6093}, {24.05554, 23.30253, 22.80391},            \
    {24.19807, 23.46362, 22.9979}, {24.33983, 23.62399, 23.19129}, {24.48084, 23.78364, 23.38405},           \
    {24.6211, 23.94256, 23.5762}, {24.76062, 24.10075, 23.76771}, {24.89939, 24.25823, 23.95859},            \
    {25.03742, 24.41498, 24.14882}, {25.17472, 24.57101, 24.33842}, {25.31128, 24.72631, 24.52736},          \
    {25.44712, 24.88089, 24.71566}, {25.58223, 25.03476, 24.90329}, {25.71662, 25.1879, 25.09026},           \
    {25.85029, 25.34032, 25.27657}, {25.98326, 25.49203, 25.46222}, {26.11551, 25.64302, 25.64719},          \
    {26.24706, 25.7933, 25.83148}, {26.37791, 25.94287, 26.01511}, {26.50806, 26.09172, 26.19805},           \
    {26.63752, 26.23987, 26.38031}, {26.76629, 26.38731, 26.56189}, {26.89438, 26.53405, 26.74279},          \
    {27.02178, 26.68008, 26.923}, {27.14852, 26.82542, 27.10252}, {27.27458, 26.97005, 27.28135},            \
    {27.39998, 27.11399, 27.4595}, {27.52471, 27.25724, 27.63695}, {27.64879, 27.3998, 27.81371},            \
    {27.77221, 27.54167, 27.98978}, {27.89499, 27.68286, 28.16515}, {28.01712, 27.82337, 28.33984},          \
    {28.13861, 27.96319, 28.51383}, {28.25946, 28.10235, 28.68712}, {28.37968, 28.24082, 28.85973},          \
    {28.49928, 28.37863, 29.03163}, {28.61825, 28.51577, 29.20285}, {28.7366, 28.65225, 29.37338},           \
    {28.85435, 28.78807, 29.54321}, {28.97148, 28.92323, 29.71235}, {29.088, 29.05774, 29.8808},             \
    {29.20393, 29.1916, 30.04856}, {29.31926, 29.3248, 30.21563}, {29.434, 29.45737, 30.38202},              \
    {29.54814, 29.58929, 30.54771}, {29.66171, 29.72058, 30.71273}, {29.7747, 29.85123, 30.87706},           \
    {29.88711, 29.98126, 31.0407}, {29.99895, 30.11065, 31.20367}, {30.11023, 30.23943, 31.36596},           \
    {30.22094, 30.36758, 31.52757}, {30.3311, 30.49512, 31.6885}, {30.4407, 30.62204, 31.84876},             \
    {30.54975, 30.74835, 32.00834}, {30.65826, 30.87406, 32.16726}, {30.76623, 30.99917, 32.32551},          \
    {30.87365, 31.12368, 32.48309}, {30.98055, 31.24759, 32.64001}, {31.08692, 31.37092, 32.79626},          \
    {31.19276, 31.49365, 32.95186}, {31.29808, 31.6158, 33.1068}, {31.40289, 31.73737, 33.26108},            \
    {31.50718, 31.85836, 33.41471}, {31.61096, 31.97879, 33.56769}, {31.71424, 32.09864, 33.72002},          \
    {31.81701, 32.21792, 33.8717}, {31.91929, 32.33664, 34.02275}, {32.02108, 32.45481, 34.17315},           \
    {32.12237, 32.57241, 34.32291}, {32.22318, 32.68947, 34.47204}, {32.32351, 32.80598, 34.62054},          \
    {32.42336, 32.92194, 34.76841}, {32.52274, 33.03736, 34.91565}, {32.62164, 33.15225, 35.06226},          \
    {32.72008, 33.2666, 35.20825}, {32.81805, 33.38042, 35.35363}, {32.91556, 33.49372, 35.49839},           \
    {33.01262, 33.60649, 35.64253}, {33.10922, 33.71874, 35.78607}, {33.20538, 33.83047, 35.92899},          \
    {33.30108, 33.9417, 36.07131}, {33.39635, 34.05241, 36.21303}, {33.49117, 34.16262, 36.35416},           \
    {33.58557, 34.27232, 36.49468}, {33.67952, 34.38152, 36.63462}, {33.77305, 34.49023, 36.77396},          \
    {33.86616, 34.59845, 36.91271}, {33.95884, 34.70618, 37.05089}, {34.0511, 34.81342, 37.18848},           \
    {34.14295, 34.92018, 37.32549}, {34.23438, 35.02646, 37.46193}, {34.3254, 35.13227, 37.59779},           \
    {34.41602, 35.2376, 37.73309}, {34.50624, 35.34247, 37.86782}, {34.59605, 35.44687, 38.00198},           \
    {34.68547, 35.5508, 38.13559}, {34.77449, 35.65428, 38.26864}, {34.86313, 35.7573, 38.40114},            \
    {34.95137, 35.85987, 38.53308}, {35.03923, 35.96199, 38.66448}, {35.12671, 36.06366, 38.79533},          \
    {35.21381, 36.16489, 38.92564}, {35.30053, 36.26567, 39.05541}, {35.38688, 36.36602, 39.18464},          \
    {35.47286, 36.46594, 39.31334}, {35.55848, 36.56542, 39.44151}, {35.64372, 36.66448, 39.56916},          \
    {35.72861, 36.76311, 39.69628}, {35.81313, 36.86132, 39.82288}, {35.8973, 36.95911, 39.94896},           \
    {35.98112, 37.05648, 40.07453}, {36.06458, 37.15344, 40.19958}, {36.1477, 37.24999, 40.32412},           \
    {36.23047, 37.34613, 40.44816}, {36.3129, 37.44186, 40.5717}, {36.39498, 37.5372, 40.69473},             \
    {36.47673, 37.63213, 40.81727}, {36.55815, 37.72667, 40.93931}, {36.63923, 37.82082, 41.06086},          \
    {36.71997, 37.91457, 41.18193}, {36.8004, 38.00794, 41.3025}, {36.88049, 38.10092, 41.4226},             \
    {36.96026, 38.19351, 41.54221}, {37.03971, 38.28573, 41.66135}, {37.11885, 38.37757, 41.78001},          \
    {37.19766, 38.46904, 41.8982}, {37.27617, 38.56013, 42.01592}, {37.35436, 38.65086, 42.13317},           \
    {37.43224, 38.74122, 42.24997}, {37.50981, 38.83121, 42.3663}, {37.58709, 38.92084, 42.48217},           \
    {37.66405, 39.01011, 42.59759}, {37.74072, 39.09903, 42.71256}, {37.81709, 39.18759, 42.82707},          \
    {37.89317, 39.2758, 42.94114}, {37.96895, 39.36366, 43.05477}, {38.04443, 39.45117, 43.16796},           \
    {38.11963, 39.53834, 43.2807}, {38.19455, 39.62517, 43.39301}, {38.26917, 39.71166, 43.50489}            \
  }

color blackbody(float temperatureK) {
  if (temperatureK < 800) return color(1e-6, 0, 0);  // A red that no eye sees.
  if (temperatureK >= 12000) return aerosol_blackbody(temperatureK);
  color table[317] = AEROSOL_BLACKBODY;
  float at = pow((temperatureK - 800) / 2, 2.0 / 3.0);
  int i = (int)at;
  color c = mix(table[i], table[i + 1], at - i);
  return c * c * c * c * c;
}
#undef AEROSOL_BLACKBODY

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
