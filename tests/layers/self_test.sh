#!/usr/bin/env bash
# Plants one violation of each rule in a small tree and expects it to be reported at its line, and nothing without it.
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(mktemp -d)
trap 'rm -rf "$root"' EXIT
failures=0

fresh() {
  rm -rf "${root:?}"/*
  mkdir -p "$root"/core/{base,lang/preprocessor,jit/runtime,accel,image/module,render} "$root"/plugins/lights "$root"/tests/unit/jit
  echo '#include <vector>' >"$root/core/base/a.h"
  echo '#include "core/base/a.h"' >"$root/core/lang/abi.h"
  printf '// first\n#include <llvm/IR/Module.h>\n' >"$root/core/jit/wrapper.h"
  echo '#include "core/jit/wrapper.h"' >"$root/core/jit/user.cpp"
  echo '#include "core/lang/abi.h"' >"$root/core/jit/runtime/runtime.cpp"
  printf '#include <clang/Lex/Preprocessor.h>\n#include <llvm/Support/MemoryBuffer.h>\n' >"$root/core/lang/preprocessor/one.cpp"
  printf '#include <gtest/gtest.h>\n#include "core/jit/wrapper.h"\n' >"$root/tests/unit/jit/wrapper_test.cpp"
}

# expect NAME PATTERN: the check fails and prints a line that contains PATTERN; an empty pattern means that it passes.
expect() {
  local output status=0
  output=$(bash "$here/check_layers.sh" "$root") || status=$?
  if [ -z "$2" ] && [ "$status" -eq 0 ]; then return; fi
  if [ -n "$2" ] && [ "$status" -ne 0 ] && grep -qF -- "$2" <<<"$output"; then return; fi
  echo "$1: exit $status, expected '${2:-success}', got:"
  echo "$output"
  failures=$((failures + 1))
}

fresh
expect "a tree that keeps the rule" ""

fresh
echo '#include "core/jit/user.cpp"' >>"$root/core/lang/abi.h"
expect "an upward include" 'core/lang/abi.h:2: layer lang may not include'

fresh
echo '#include "core/lang/abi.h"' >"$root/core/accel/mesh.cpp"
expect "a sideways include" 'core/accel/mesh.cpp:1: layer accel may not include'

fresh
echo '#include "plugins/lights/sun.h"' >"$root/core/render/scene.cpp"
touch "$root/plugins/lights/sun.h"
expect "core including a plugin" 'core/render/scene.cpp:1: layer render may not include'

fresh
echo '  #  include <embree3/rtcore.h>' >"$root/core/render/scene.cpp"
expect "a library outside its wrapper" 'core/render/scene.cpp:1: <embree3/rtcore.h> belongs in core/accel/'

fresh
echo '#include <OpenImageIO/imageio.h>' >"$root/core/image/read.cpp"
expect "a slow library outside its module" 'core/image/read.cpp:1: <OpenImageIO/imageio.h> belongs in core/image/module/'

fresh
printf '#include "core/base/a.h"\n#include "core/jit/wrapper.h"\n' >"$root/core/render/middle.h"
echo '#include "core/render/middle.h"' >"$root/plugins/lights/sun.cpp"
expect "a library's header reached through ours" 'core/render/middle.h:2: reaches <llvm/…> through "core/jit/wrapper.h"'
expect "a library's header reached through two of ours" 'plugins/lights/sun.cpp:1: reaches <llvm/…>'

fresh
echo '#include "a.h"' >"$root/core/base/b.h"
expect "an include not from the root" 'core/base/b.h:1: "a.h" is no file'

fresh
echo '#include "core/base/a.h"' >>"$root/core/jit/runtime/runtime.cpp"
expect "the runtime library including the program" "core/jit/runtime/runtime.cpp:2: the kernels' runtime library may not"

fresh
echo '#include <clang/Lex/Lexer.h>' >"$root/core/lang/preprocessor/two.cpp"
expect "clang's headers in two files" "core/lang/preprocessor/two.cpp:1: clang's headers belong in one file"

fresh
mkdir "$root/core/stray"
echo '#include "core/base/a.h"' >"$root/core/stray/a.cpp"
expect "an unknown layer" "core/stray/a.cpp:1: 'stray' is not a layer"

rm -rf "${root:?}"/*
mkdir "$root/core"
expect "an empty tree" 'no source files found'

exit $((failures > 0))
