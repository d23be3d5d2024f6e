// The table's shaders over a vector of floats, with masks instead of branches. Included by the sources that are
// compiled for this machine alone.
#pragma once

#include <cmath>
#include <utility>

#include "tests/bench/shader_table/references.h"
#include "tests/bench/shader_table/vector_math.h"

namespace aerosol::bench {
namespace {

template <int W>
struct Patterns : Functions<W> {
  using Base = Functions<W>;
  using L = Lanes<W>;
  using M = VectorMath<W>;
  using Float = typename L::Float;
  using Int = typename L::Int;
  using Word = typename L::Word;

  struct Triple {
    Float x, y, z;
  };
  static Triple load(const float* x, const float* y, const float* z, std::size_t i) {
    return {L::load(x + i), L::load(y + i), L::load(z + i)};
  }

  // Hashes ---------------------------------------------------------------------------------------------------------

  static Word finish(Word a, Word b, Word c) {
    c ^= b, c -= L::rotate(b, 14);
    a ^= c, a -= L::rotate(c, 11);
    b ^= a, b -= L::rotate(a, 25);
    c ^= b, c -= L::rotate(b, 16);
    a ^= c, a -= L::rotate(c, 4);
    b ^= a, b -= L::rotate(a, 14);
    c ^= b, c -= L::rotate(b, 24);
    return c;
  }
  static Word hash4(Word x, Word y, Word z, Word w) {
    const Word seed(0xdeadbeefu + (4u << 2) + 13u);
    Word a = seed + x, b = seed + y, c = seed + z;
    a -= c, a ^= L::rotate(c, 4), c += b;
    b -= a, b ^= L::rotate(a, 6), a += c;
    c -= b, c ^= L::rotate(b, 8), b += a;
    a -= c, a ^= L::rotate(c, 16), c += b;
    b -= a, b ^= L::rotate(a, 19), a += c;
    c -= b, c ^= L::rotate(b, 4), b += a;
    return finish(a + w, b, c);
  }
  static Float unit(Word bits) { return __builtin_convertvector(bits, Float) * Float(2.32830644e-10f); }

  // Gradient noise of several kinds ----------------------------------------------------------------------------------

  struct Axis {
    Word cell[2];
    Float offset[2];
    Float fade;
  };
  static Axis axis(Float x) {
    const Float low = L::floor(x), t = x - low;
    const Word cell = L::toWord(low);
    return {{cell, cell + Word(1)}, {t, t - Float(1)}, Base::fade(t)};
  }
  static Axis wrapped(Float x, float period) {
    Axis result = axis(x);
    const Float low = L::floor(x);
    result.cell[0] = L::toWord(low - Float(period) * L::floor(low * Float(1 / period)));
    const Word next = result.cell[0] + Word(1);
    result.cell[1] = next == Word(static_cast<unsigned>(period)) ? Word(0) : next;
    return result;
  }
  template <class Corner>
  static Float blend(const Axis& x, const Axis& y, const Axis& z, Corner&& corner) {
    const auto plane = [&](int k) {
      return Base::mix(Base::mix(corner(0, 0, k), corner(1, 0, k), x.fade),
                       Base::mix(corner(0, 1, k), corner(1, 1, k), x.fade), y.fade);
    };
    return Base::mix(plane(0), plane(1), z.fade);
  }

  static void color(Triple p, float* results, std::size_t) {
    const Axis x = axis(p.x * Float(4)), y = axis(p.y * Float(4)), z = axis(p.z * Float(4));
    Word hashes[2][2][2];
    for (int i = 0; i < 8; ++i)
      hashes[i & 1][i >> 1 & 1][i >> 2] = Base::hash(x.cell[i & 1], y.cell[i >> 1 & 1], z.cell[i >> 2]);
    const auto channel = [&](unsigned shift) {
      const Float n = blend(x, y, z, [&](int i, int j, int k) {
        return Base::gradient(hashes[i][j][k] >> Word(shift), x.offset[i], y.offset[j], z.offset[k]);
      });
      return L::fma(n * Float(0.982f), Float(0.5f), Float(0.5f));
    };
    L::store(results, channel(0) + Float(2) * channel(8) + Float(3) * channel(16));
  }

  static void periodic(Triple p, float* results, std::size_t) {
    const Axis x = wrapped(p.x * Float(8), 4), y = wrapped(p.y * Float(8), 5), z = wrapped(p.z * Float(8), 6);
    L::store(results, Float(0.982f) * blend(x, y, z, [&](int i, int j, int k) {
                        return Base::gradient(Base::hash(x.cell[i], y.cell[j], z.cell[k]), x.offset[i], y.offset[j],
                                              z.offset[k]);
                      }));
  }

  static Float gradient4(Word h, Float x, Float y, Float z, Float w) {
    const Word low = h & Word(31);
    const Float u = L::choose(low < Word(24), x, y), v = L::choose(low < Word(16), y, z),
                s = L::choose(low < Word(8), z, w);
    return L::flip(u, h, 0) + L::flip(v, h, 1) + L::flip(s, h, 2);
  }
  static void moving(Triple p, float* results, std::size_t) {
    const Axis x = axis(p.x * Float(4)), y = axis(p.y * Float(4)), z = axis(p.z * Float(4)), w = axis(p.x + p.y);
    const auto cube = [&](int l) {
      return blend(x, y, z, [&](int i, int j, int k) {
        return gradient4(hash4(x.cell[i], y.cell[j], z.cell[k], w.cell[l]), x.offset[i], y.offset[j], z.offset[k],
                         w.offset[l]);
      });
    };
    L::store(results, Float(0.8344f) * Base::mix(cube(0), cube(1), w.fade));
  }

  // Noise without interpolation --------------------------------------------------------------------------------------

  static void cells(Triple p, float* results, std::size_t) {
    Float sum(0);
    for (int octave = 0; octave < 4; ++octave) {
      const Float scale(static_cast<float>(2 << octave));
      sum += unit(Base::hash(L::toWord(L::floor(p.x * scale)), L::toWord(L::floor(p.y * scale)),
                             L::toWord(L::floor(p.z * scale))));
    }
    L::store(results, sum);
  }
  static void hashes(Triple p, float* results, std::size_t) {
    const auto bits = [](Float x) { return __builtin_bit_cast(Word, x); };
    Float sum(0);
    for (int octave = 0; octave < 4; ++octave) {
      const Float scale(static_cast<float>(2 << octave));
      sum += unit(Base::hash(bits(p.x * scale), bits(p.y * scale), bits(p.z * scale)));
    }
    L::store(results, sum);
  }
  static void worley(Triple p, float* results, std::size_t) {
    const Float qx = p.x * Float(4), qy = p.y * Float(4), qz = p.z * Float(4);
    Float best(1e9f);
    for (int i = -1; i <= 1; ++i) {
      for (int j = -1; j <= 1; ++j) {
        for (int k = -1; k <= 1; ++k) {
          const Float cx = L::floor(qx) + Float(static_cast<float>(i)),
                      cy = L::floor(qy) + Float(static_cast<float>(j)),
                      cz = L::floor(qz) + Float(static_cast<float>(k));
          const Word wx = L::toWord(cx), wy = L::toWord(cy), wz = L::toWord(cz);
          const Float dx = cx + unit(hash4(wx, wy, wz, Word(0))) - qx, dy = cy + unit(hash4(wx, wy, wz, Word(1))) - qy,
                      dz = cz + unit(hash4(wx, wy, wz, Word(2))) - qz;
          best = __builtin_elementwise_min(best, dx * dx + dy * dy + dz * dz);
        }
      }
    }
    L::store(results, L::root(best));
  }

  // Simplex noise (Gustavson's formulation) --------------------------------------------------------------------------

  static constexpr std::uint32_t packed(const int (&entries)[16]) {
    std::uint32_t table = 0;
    for (int i = 0; i < 16; ++i) table |= (static_cast<std::uint32_t>(entries[i]) & 3u) << (2 * i);
    return table;
  }
  static Float simplexCorner(Int i, Int j, Int k, Triple d) {
    constexpr std::uint32_t gx = packed({1, 0, -1, 0, 1, 0, -1, 0, 1, 1, -1, -1, 1, -1, 0, 0});
    constexpr std::uint32_t gy = packed({0, 1, 0, -1, 0, 1, 0, -1, -1, 1, 1, -1, 0, 0, 1, -1});
    constexpr std::uint32_t gz = packed({1, 1, 1, 1, -1, -1, -1, -1, 0, 0, 0, 0, 1, 1, -1, -1});
    const Word magic(0xdeadbeefu);
    const Word inner = finish(__builtin_bit_cast(Word, k), Word(0), magic);
    const Word h = finish(__builtin_bit_cast(Word, i), __builtin_bit_cast(Word, j), inner ^ magic) & Word(15);
    const auto entry = [&](std::uint32_t table) {
      const Int two = __builtin_bit_cast(Int, Word(table) << (Word(30) - (h + h)));
      return __builtin_convertvector(two >> Int(30), Float);
    };
    const Float dot = entry(gx) * d.x + entry(gy) * d.y + entry(gz) * d.z;
    const Float t = __builtin_elementwise_max(Float(0.5f) - d.x * d.x - d.y * d.y - d.z * d.z, Float(0));
    const Float square = t * t;
    return square * square * dot;
  }
  static Float simplexAt(Triple p) {
    const Float s = (p.x + p.y + p.z) * Float(0.333333333f);
    const auto cell = [](Float x) { return __builtin_convertvector(L::floor(x), Int); };
    const auto real = [](Int x) { return __builtin_convertvector(x, Float); };
    const Int i = cell(p.x + s), j = cell(p.y + s), k = cell(p.z + s);
    const Float t = real(i + j + k) * Float(0.166666667f);
    const Triple d = {p.x - (real(i) - t), p.y - (real(j) - t), p.z - (real(k) - t)};
    const Int xy = d.x >= d.y, yz = d.y >= d.z, xz = d.x >= d.z;
    const Int i1 = (xy & xz) & Int(1), j1 = (~xy & yz) & Int(1), k1 = Int(1) - i1 - j1;
    const Int i2 = (xy | xz) & Int(1), j2 = (~xy | yz) & Int(1), k2 = Int(2) - i2 - j2;
    const auto corner = [&](Int di, Int dj, Int dk, float c) {
      return simplexCorner(i + di, j + dj, k + dk,
                           {d.x - real(di) + Float(c), d.y - real(dj) + Float(c), d.z - real(dk) + Float(c)});
    };
    return Float(68) * (simplexCorner(i, j, k, d) + corner(i1, j1, k1, 0.166666667f) +
                        corner(i2, j2, k2, 0.333333333f) + corner(Int(1), Int(1), Int(1), 0.5f));
  }
  static void simplex(Triple p, float* results, std::size_t) {
    Float sum(0), weight(0.5f);
    for (int octave = 0; octave < 4; ++octave) {
      sum += weight * simplexAt(p);
      p = {p.x * Float(2), p.y * Float(2), p.z * Float(2)};
      weight *= Float(0.5f);
    }
    L::store(results, sum);
  }

  // Gabor noise: isotropic, bandwidth 1, 16 impulses, unfiltered -----------------------------------------------------

  static Float next(Word& state) {
    state *= Word(3039177861u);
    const Float x = __builtin_convertvector(__builtin_bit_cast(Int, state), Float) * Float(2.3283064365386963e-10f);
    return L::choose(x < Float(0), x + Float(1), x);
  }
  static void gabor(Triple p, float* results, std::size_t) {
    const float a = static_cast<float>(2.0 / 3 * std::sqrt(M_PI / M_LN2));
    const float radius = std::sqrt(-std::log(0.02f) / static_cast<float>(M_PI)) / a;
    const float mean = 16 / static_cast<float>(4 * M_PI / 3), none = std::exp(-mean);
    const Float gx = p.x * Float(4 / radius), gy = p.y * Float(4 / radius), gz = p.z * Float(4 / radius);
    const Float fx = L::floor(gx), fy = L::floor(gy), fz = L::floor(gz);
    const Float tau(6.2831853f);
    Float sum(0);
    for (int cell = 0; cell < 27; ++cell) {
      const Float i(static_cast<float>(cell % 3 - 1)), j(static_cast<float>(cell / 3 % 3 - 1)),
          k(static_cast<float>(cell / 9 - 1));
      Word state = hash4(L::toWord(fx + i), L::toWord(fy + j), L::toWord(fz + k), Word(0));
      state = state == Word(0) ? Word(1) : state;
      // A Poisson number of impulses; a lane that has its number keeps its state.
      Int count(0);
      Word tried = state;
      Float product = next(tried);
      state = tried;
      for (Int going = product > Float(none); L::any(going); going = going & (product > Float(none))) {
        count -= going;
        const Float factor = next(tried);
        state = going ? tried : state;
        tried = state;
        product = L::choose(going, product * factor, product);
      }
      const int most = __builtin_reduce_max(count);
      for (int impulse = 0; impulse < most; ++impulse) {
        const Float z = next(state), y = next(state), x = next(state);
        const Float ox = Float(radius) * (gx - fx - i - x), oy = Float(radius) * (gy - fy - j - y),
                    oz = Float(radius) * (gz - fz - k - z);
        Float s, c;
        M::sincos(tau * next(state), s, c);
        const Float height = Float(2) * next(state) - Float(1), around = L::root(Float(1) - height * height);
        const Float phase = tau * next(state);
        const Float square = ox * ox + oy * oy + oz * oz;
        const Int within = (square < Float(radius * radius)) & (count > Int(impulse));
        if (!L::any(within)) continue;
        const Float along = c * around * ox + s * around * oy + height * oz;
        const Float kernel = M::exp(Float(-static_cast<float>(M_PI) * a * a) * square) * M::cos(tau * along + phase);
        sum += L::choose(within, kernel, Float(0));
      }
    }
    const float density = mean / (radius * radius * radius), variance = 1 / (4 * 1.4142135f * a * a * a);
    L::store(results, sum * Float(0.5f / (3 * std::sqrt(variance) * std::sqrt(density))));
  }

  // Beyond noise -----------------------------------------------------------------------------------------------------

  static void fractal(Triple p, float* results, std::size_t) { L::store(results, Base::fbm(p.x, p.y, p.z)); }
  static void ball(Triple p, float* results, std::size_t) { L::store(results, Base::pyroclastic(p.x, p.y, p.z)); }

  /// The values that the renderer takes from the closures: two weights that vary, two normals, a roughness.
  static void material(Triple p, float* results, std::size_t n) {
    const Float length = Base::length(p.x, p.y, p.z);
    const Float nx = p.x / length, ny = p.y / length, nz = p.z / length;
    const Float grazing = Float(1) - L::absolute(nz), square = grazing * grazing;
    const Float fresnel = L::fma(Float(0.96f), square * square * grazing, Float(0.04f));
    const Float wear = Base::noise(p.x * Float(3), p.y * Float(3), p.z * Float(3));
    const Float roughness =
        __builtin_elementwise_min(__builtin_elementwise_max(Float(0.3f) + Float(0.2f) * wear, Float(0.05f)), Float(1));
    const Float kept = Float(1) - fresnel;
    const Float values[] = {kept * Float(0.8f),
                            kept * Float(0.5f),
                            kept * Float(0.2f),
                            nx,
                            ny,
                            nz,
                            fresnel,
                            fresnel,
                            fresnel,
                            nx,
                            ny,
                            nz,
                            roughness,
                            roughness,
                            Float(0.1f),
                            Float(0.1f),
                            Float(0.1f)};
    for (std::size_t i = 0; i < std::size(values); ++i) L::store(results + i * n, values[i]);
  }

  /// Strings are numbers: 0 swirl, 1 wave, 2 grid.
  static void words(Triple p, float* results, std::size_t) {
    const Float cell = L::floor(p.x * Float(4));
    const Float name = cell - Float(3) * L::floor(cell / Float(3));
    Float s, c;
    M::sincos(Float(3) * p.z, s, c);
    // turn * stretch, whose last columns are 0 0 0 1.
    const Float m[4][3] = {{c, Float(0.2f) * c + Float(1.5f) * s, Float(0.1f) * s},
                           {-s, Float(1.5f) * c - Float(0.2f) * s, Float(0.1f) * c},
                           {Float(0.3f), Float(0), Float(1)},
                           {Float(0.1f) + Float(0.09f), Float(0.02f) + Float(0.3f), Float(0.02f) + Float(0.3f)}};
    Float q[3];
    for (int i = 0; i < 3; ++i) q[i] = p.x * m[0][i] + p.y * m[1][i] + p.z * m[2][i] + m[3][i];
    const Float determinant = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
                              m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
                              m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
    L::store(results, L::choose(name == Float(0), determinant + q[0],
                                L::choose(name == Float(1), q[1] * q[2], Float(4) * q[2])));
  }

  // The group: 50 layers of 20 lines, in the order of groupLayer() in shaders.cpp
  // -----------------------------------------

  struct State {
    Float x, y, tint[3];
  };
  template <int kind, int constant>
  static void line(State& s) {
    const Float c(static_cast<float>(constant));
    const auto mixed = [](Float a, Float b) { return a * Float(0.75f) + b * Float(0.25f); };
    if constexpr (kind == 0) s.x = s.x * Float(0.5f) + M::sin(s.y);
    if constexpr (kind == 1) s.y = Float(0.5f) * s.y + Float(0.1f) * __builtin_elementwise_max(s.x, c);
    if constexpr (kind == 2) {
      s.tint[0] = mixed(s.tint[0], s.x);
      s.tint[1] = mixed(s.tint[1], s.y);
      s.tint[2] = mixed(s.tint[2], c);
    }
    if constexpr (kind == 3)
      s.x = __builtin_elementwise_max(__builtin_elementwise_min(s.x + Float(0.1f) * s.tint[0], c), -c);
  }
  template <int layer, int... lines>
  static void layerLines(State& s, std::integer_sequence<int, lines...>) {
    (line<(layer + lines) % 4, lines % 7 + 1>(s), ...);
  }
  template <int... layers>
  static void layersOf(Triple p, State& s, std::integer_sequence<int, layers...>) {
    const auto one = [&](auto layer) {
      s.x = s.x + p.x;
      s.y = p.y;
      layerLines<decltype(layer)::value>(s, std::make_integer_sequence<int, 17>{});
      s.x = s.x + s.y;
    };
    (one(std::integral_constant<int, layers>{}), ...);
  }
  static void group(Triple p, float* results, std::size_t) {
    State s{Float(0.5f), Float(0), {Float(0.25f), Float(0.25f), Float(0.25f)}};
    layersOf(p, s, std::make_integer_sequence<int, 50>{});
    L::store(results, s.x);
  }

  template <void (*function)(Triple, float*, std::size_t)>
  static void run(const float* x, const float* y, const float* z, float* results, std::size_t n) {
    for (std::size_t i = 0; i < n; i += W) function(load(x, y, z, i), results + i, n);
  }

  static std::map<std::string, PatternFunction> all() {
    return {{"fbm", &run<fractal>},         {"pyroclastic", &run<ball>},  {"color_noise", &run<color>},
            {"moving_noise", &run<moving>}, {"periodic", &run<periodic>}, {"cells", &run<cells>},
            {"hashes", &run<hashes>},       {"simplex", &run<simplex>},   {"gabor", &run<gabor>},
            {"worley", &run<worley>},       {"material", &run<material>}, {"words", &run<words>},
            {"group", &run<group>}};
  }
};

}  // namespace
}  // namespace aerosol::bench
