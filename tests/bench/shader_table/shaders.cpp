#include "tests/bench/shader_table/shaders.h"

#include <fmt/format.h>

#include <stdexcept>

#include "core/lang/compile.h"

namespace aerosol::bench {

namespace {

constexpr const char* octaves = R"(
  float sum = 0, weight = 0.5;
  point q = P;
  for (int octave = 0; octave < {0}; octave++) {{
    sum += weight * {1};
    q *= 2;
    weight *= 0.5;
  }}
  density = sum;
)";

/// A shader of one output `density`.
TableShader pattern(const std::string& name, const std::string& body) {
  return {name, fmt::format("shader {}(output float density = 0) {{{}}}\n", name, body),
          fmt::format(
              "shader {}(output float density = 0, output float width = 0) {{{}  width = filterwidth(density);\n}}\n",
              name, body)};
}

TableShader fractal(const std::string& name, int count, const char* term) {
  return pattern(name, fmt::format(fmt::runtime(octaves), count, term));
}

constexpr const char* pyroclastic = R"(
  float radius = length(P);
  if (radius < 1.5) {
    float sum = 0, weight = 0.5;
    point q = P;
    for (int octave = 0; octave < 6; octave++) {
      sum += weight * fabs(snoise(q));
      q *= 2;
      weight *= 0.5;
    }
    float d = 1 + sum - radius;
    if (d > 0) density = d;
  }
)";

constexpr const char* summed = R"(
  float sum = 0, scale = 2;
  for (int octave = 0; octave < 4; octave++) {{
    sum += {}(scale * P);
    scale *= 2;
  }}
  density = sum;
)";

constexpr const char* worley = R"(
  point q = 4 * P, corner = floor(q);
  float best = 1e9;
  for (int i = -1; i <= 1; i++)
    for (int j = -1; j <= 1; j++)
      for (int k = -1; k <= 1; k++) {
        point cell = corner + vector(i, j, k);
        vector away = cell + (vector)cellnoise(cell) - q;
        best = min(best, dot(away, away));
      }
  density = sqrt(best);
)";

constexpr const char* words = R"(
  string names[3];
  split(styles, names, ",");
  string name = names[(int)mod(floor(4 * P[0]), 3.0)];
  float s, c;
  sincos(3 * P[2], s, c);
  matrix turn = matrix(c, s, 0, 0, -s, c, 0, 0, 0, 0, 1, 0, 0.1, 0.2, 0.3, 1);
  matrix stretch = matrix(1, 0.2, 0, 0, 0, 1.5, 0.1, 0, 0.3, 0, 1, 0, 0, 0, 0, 1);
  matrix both = turn * stretch;
  point q = transform(both, P);
  if (name == "swirl") density = determinant(both) + q[0];
  else if (name == "wave") density = q[1] * q[2];
  else density = strlen(name) * q[2];
)";

constexpr const char* material = R"(
surface material(color base = color(0.8, 0.5, 0.2)) {
  normal n = normalize((normal)P);
  float grazing = 1 - fabs(n[2]), square = grazing * grazing;
  float fresnel = 0.96 * square * square * grazing + 0.04;
  float roughness = clamp(0.3 + 0.2 * snoise(3 * P), 0.05, 1.0);
  Ci = (1 - fresnel) * base * diffuse(n) + fresnel * microfacet("ggx", n, roughness, 1.5, 0) + 0.1 * transparent();
}
)";

std::string layerSource(int index) {
  static constexpr const char* statements[] = {"  x = x * 0.5 + sin(y);\n", "  y = 0.5 * y + 0.1 * max(x, {}.0);\n",
                                               "  tint = mix(tint, color(x, y, {}), 0.25);\n",
                                               "  x = clamp(x + 0.1 * tint[0], -{0}.0, {0}.0);\n"};
  std::string body;
  for (int line = 0; line < 17; ++line)
    body += fmt::format(fmt::runtime(statements[static_cast<std::size_t>((index + line) % 4)]), line % 7 + 1);
  return fmt::format(
      "shader layer{}(float a = 0.5, color c = 0.25, output float out = 0, output color cout = 0) {{\n"
      "  float x = a + P[0], y = P[1]; color tint = c;\n{}  out = x + y; cout = tint;\n}}\n",
      index, body);
}

}  // namespace

std::vector<TableShader> tableShaders() {
  TableShader choice = pattern("words", words);
  for (std::string* source : {&choice.source, &choice.widthSource})
    source->insert(source->find('(') + 1, "string styles = \"swirl,wave,grid\", ");
  return {fractal("fbm", 6, "snoise(q)"),
          pattern("pyroclastic", pyroclastic),
          pattern("color_noise", "\n  color c = noise(4 * P);\n  density = c[0] + 2 * c[1] + 3 * c[2];\n"),
          pattern("moving_noise", "\n  density = snoise(4 * P, P[0] + P[1]);\n"),
          pattern("periodic", "\n  density = psnoise(8 * P, point(4, 5, 6));\n"),
          pattern("cells", fmt::format(fmt::runtime(summed), "cellnoise")),
          pattern("hashes", fmt::format(fmt::runtime(summed), "hashnoise")),
          fractal("simplex", 4, "(float)noise(\"simplex\", q)"),
          pattern("gabor", "\n  density = noise(\"gabor\", 4 * P, \"do_filter\", 0);\n"),
          pattern("worley", worley),
          {"material", material, ""},
          choice};
}

lang::Group chainOfLayers(int count, int salt) {
  lang::CompileOptions options;
  options.standardLibrary = AEROSOL_SOURCE_DIR "/shaders/stdosl.h";
  lang::Group group;
  for (int i = 0; i < count; ++i) {
    const auto source = lang::compileString(layerSource(i + salt), fmt::format("layer{}.osl", i), options);
    if (!source) throw std::runtime_error(format(source.errors()));
    group.layers.push_back({fmt::format("l{}", i), source->layer, {}, {}});
    if (i == 0) continue;
    const std::string from = fmt::format("l{}", i - 1), to = fmt::format("l{}", i);
    group.connections.push_back({from, "out", to, "a", {}, {}});
    group.connections.push_back({from, "cout", to, "c", {}, {}});
  }
  return group;
}

TableShader textureShader() {
  return {"texture",
          "shader texture_(string file = \"\", output float density = 0) {\n"
          "  color c = texture(file, P[0], P[1], 0.01, 0, 0, 0.01, \"wrap\", \"periodic\");\n  density = c[1];\n}\n",
          ""};
}

}  // namespace aerosol::bench
