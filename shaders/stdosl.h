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

// Patterns -------------------------------------------------------------------------------------------------------------

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

closure color mix(closure color x, closure color y, float a) { return x * (1 - a) + y * a; }
closure color mix(closure color x, closure color y, color a) { return x * (1 - a) + y * a; }

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

// Between "rgb", "hsv", "hsl", "YIQ", "XYZ" and "xyY".
color transformc(string from, string to, color c) {
  color rgb = c;
  if (from == to) return c;
  if (from == "hsv") rgb = aerosol_rgb_from_hsv(c);
  else if (from == "hsl") rgb = aerosol_rgb_from_hsl(c);
  else if (from == "YIQ") rgb = aerosol_rgb_from_yiq(c);
  else if (from == "XYZ") rgb = aerosol_rgb_from_xyz(c);
  else if (from == "xyY") rgb = aerosol_rgb_from_xyz(aerosol_xyz_from_xyy(c));
  else if (from != "rgb" && from != "RGB") error("unknown colour space \"%s\"", from);
  if (to == "hsv") return aerosol_hsv_from_rgb(rgb);
  if (to == "hsl") return aerosol_hsl_from_rgb(rgb);
  if (to == "YIQ") return aerosol_yiq_from_rgb(rgb);
  if (to == "XYZ") return aerosol_xyz_from_rgb(rgb);
  if (to == "xyY") return aerosol_xyy_from_xyz(aerosol_xyz_from_rgb(rgb));
  if (to != "rgb" && to != "RGB") error("unknown colour space \"%s\"", to);
  return rgb;
}
color transformc(string to, color c) { return transformc("rgb", to, c); }

#endif
