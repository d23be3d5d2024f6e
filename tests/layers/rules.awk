# The rule of layers. Input: "file:PATH" lines, then grep's "PATH:LINE:#include …" lines.
#
#   base ← lang ← jit ← shading ← volume ← render ← plugins ← app
#   base ← scene, accel, grid, image; render also uses scene, accel, image, grid.
#
# 1. A layer includes itself and the layers below it.
# 2. A third-party library is included in the one folder that wraps it, and no file outside that layer reaches its headers
#    through ours.
# 3. Our includes are written from the root and name a file that exists.
# 4. The kernels' runtime library includes itself and the interface of kernels alone.
# 5. One translation unit sees clang's headers.

BEGIN {
  FS = ":"
  allow("base", "")
  allow("lang", "base")
  allow("jit", "base lang")
  allow("shading", "base lang jit")
  allow("volume", "base lang jit shading")
  allow("scene", "base")
  allow("accel", "base")
  allow("grid", "base")
  allow("image", "base")
  allow("render", "base lang jit shading volume scene accel image grid")
  allow("plugins", "base lang jit shading volume scene accel image render grid")
  allow("app", "base lang jit shading volume scene accel image render grid plugins")
  # Prefix of the include, folder that may have it.
  wrap("llvm/", "core/jit/")
  wrap("llvm-c/", "core/jit/")
  wrap("clang/", "core/lang/preprocessor/")
  wrap("clang-c/", "core/lang/preprocessor/")
  wrap("embree", "core/accel/")
  wrap("nanoflann", "core/accel/")
  wrap("OpenImageIO/", "core/image/module/")
  wrap("OpenColorIO/", "core/image/module/")
  wrap("OpenEXR/", "core/image/module/")
  wrap("openvdb/", "core/grid/")
  wrap("nanovdb/", "core/grid/")
  wrap("pugixml", "core/scene/")
  wrap("xxh", "core/base/")
  wrap("CLI/", "core/app/")
  wrap("gtest/", "tests/")
  wrap("gmock/", "tests/")
  wrap("rapidcheck", "tests/")
  wrap("benchmark/", "tests/")
}

$1 == "file" {
  exists[$2] = 1
  ++files
  next
}

{
  path = $1
  line = $2
  text = substr($0, length($1) + length($2) + 3)
  if (match(text, /<[^>]*>/)) {
    outside(path, line, substr(text, RSTART + 1, RLENGTH - 2))
  } else if (match(text, /"[^"]*"/)) {
    inside(path, line, substr(text, RSTART + 1, RLENGTH - 2))
  }
}

END {
  if (files == 0) report("", 0, "no source files found")
  for (path in reaches) follow(path)
  for (path in clangFiles) ++clangCount
  if (clangCount > 1)
    for (path in clangFiles) report(path, clangFiles[path], "clang's headers belong in one file, and " clangCount " have them")
  if (failures > 0) {
    print failures " includes break the rule of layers (tests/layers/rules.awk)"
    exit 1
  }
}

function allow(layer, below, names, count, i) {
  known[layer] = 1
  allowed[layer, layer] = 1
  count = split(below, names, " ")
  for (i = 1; i <= count; ++i) allowed[layer, names[i]] = 1
}

function wrap(prefix, folder) {
  home[prefix] = folder
}

function report(path, line, message) {
  print path ":" line ": " message
  ++failures
}

# The layer of a path: the folder under core/, or plugins; "tests" may use every layer.
function layerOf(path, parts) {
  split(path, parts, "/")
  return parts[1] == "core" ? parts[2] : parts[1]
}

function startsWith(text, prefix) {
  return substr(text, 1, length(prefix)) == prefix
}

function isRuntime(path) {
  return startsWith(path, "core/jit/runtime/")
}

function outside(path, line, name, prefix) {
  for (prefix in home) {
    if (!startsWith(name, prefix)) continue
    # clang's own headers pull in LLVM's.
    if (startsWith(name, "llvm/") && startsWith(path, "core/lang/preprocessor/")) continue
    # Tests and benchmarks of voxel data compare with the libraries' own.
    if (home[prefix] == "core/grid/" && (startsWith(path, "tests/unit/grid/") ||
        startsWith(path, "tests/bench/places/lookups") || startsWith(path, "tests/support/bake/"))) continue
    if (!startsWith(path, home[prefix])) report(path, line, "<" name "> belongs in " home[prefix])
    if (prefix == "clang/") clangFiles[path] = line
    carries[path, prefix] = 1
  }
}

function inside(path, line, name, from, to) {
  from = layerOf(path)
  to = layerOf(name)
  # The plain C interface of native plugins, which stands by itself.
  if (startsWith(path, "plugins/sdk/")) return
  if (name == "plugins/sdk/aerosol_shader.h" && (from == "shading" || from == "jit")) return
  if (!(name in exists)) {
    report(path, line, "\"" name "\" is no file; includes are written from the root")
    return
  }
  if (isRuntime(path) && !isRuntime(name) && name != "core/lang/abi.h") {
    report(path, line, "the kernels' runtime library may not include \"" name "\"")
  } else if (from == "tests") {
    # Tests use every layer.
  } else if (!(from in known)) {
    report(path, line, "'" from "' is not a layer")
  } else if (!((from, to) in allowed)) {
    report(path, line, "layer " from " may not include \"" name "\"")
  }
  reaches[path] = reaches[path] " " name
  lineOf[path, name] = line
}

# Reports third-party headers that `path` reaches through our headers in another layer than the one that wraps them.
function follow(path, seen, queue, head, tail, names, count, i, prefix, first) {
  split("", seen)
  count = split(reaches[path], names, " ")
  for (i = 1; i <= count; ++i) {
    queue[++tail] = names[i]
    first[names[i]] = names[i]
    seen[names[i]] = 1
  }
  while (head < tail) {
    ++head
    for (prefix in home) {
      if (!((queue[head], prefix) in carries)) continue
      if (!startsWith(home[prefix], "tests/") && !sameLayer(path, queue[head]))
        report(path, lineOf[path, first[queue[head]]], "reaches <" prefix "…> through \"" queue[head] "\"")
    }
    count = split(reaches[queue[head]], names, " ")
    for (i = 1; i <= count; ++i) {
      if (names[i] in seen) continue
      seen[names[i]] = 1
      first[names[i]] = first[queue[head]]
      queue[++tail] = names[i]
    }
  }
}

# A layer's unit tests may see what the layer sees; rays are compared with the library's own.
function sameLayer(path, header, layer) {
  layer = layerOf(header)
  if (layer == "accel" && path == "tests/bench/tables/mesh_rays.cpp") return 1
  return layerOf(path) == layer || startsWith(path, "tests/unit/" layer "/")
}
