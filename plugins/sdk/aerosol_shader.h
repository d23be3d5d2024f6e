/* Functions and shaders from C, C++, Rust or anything else that can speak C: plain data and functions, no library.
 *
 * A plugin is a shared object, or a file of LLVM bitcode (clang 19 or older, which is inlined into shaders), that
 * exports one constant, `aerosol_shader_plugin`. Shaders declare what they call, and name the plugin:
 *
 *     float gear_distance(point p, int teeth) [[ string native = "gear" ]];
 *
 * gear.so or gear.bc is looked for beside the shader, and where shaders are: --shader-path, AEROSOL_SHADER_PATH, the
 * scene's folder, the installed library. A shader that the plugin brings itself is used under its name, which is that
 * of the file.
 *
 * Functions work on all lanes of a call at once. What they give may depend on their arguments alone: not on the lane,
 * its neighbours, the time of day or earlier calls. They are called from many threads at the same time.
 */
#ifndef AEROSOL_SHADER_H
#define AEROSOL_SHADER_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Plugins of another version are refused. */
enum { AEROSOL_SHADER_ABI = 1 };

/* What functions may ask the host. Not for bitcode, whose `host` is null. */
typedef struct AerosolShaderHost {
  uint32_t size; /* sizeof(AerosolShaderHost) of the host: what lies behind is not there */
  /* The text of a string, UTF-8 with a 0 at its end; "" for one that is not known. Valid during the call. */
  const char* (*text)(const struct AerosolShaderHost* host, uint64_t string);
  /* A string of `length` bytes, for a lane's result. */
  uint64_t (*string)(const struct AerosolShaderHost* host, uint32_t lane, const char* text, size_t length);
  /* Leaves an error about a lane, with the place of the call. */
  void (*report)(const struct AerosolShaderHost* host, uint32_t lane, const char* text);
} AerosolShaderHost;

/* The lanes of one call. */
typedef struct AerosolLanes {
  uint32_t count;       /* 1 to 16 */
  uint32_t reserved;    /* 0 */
  const uint32_t* mask; /* by lane: all bits set or 0. The others hold anything; what is written there is not used. */
  const AerosolShaderHost* host;
} AerosolLanes;

/* `values`: the result where there is one, then the arguments in their order. Each is an array, aligned to 4 * count
 * bytes, of components (x y z of a point, vector, normal or colour; 16 of a matrix, row by row; of arrays element after
 * element), and each component is `count` floats, int32_t or (strings) uint64_t in a row: component c of lane i stands
 * at [c * count + i]. Arguments that are `output` hold their old values. None of the arrays overlap. */
typedef void (*AerosolEvaluate)(const AerosolLanes* lanes, void* const* values);

/* The range version: of every value, its least in `low` and its greatest in `high`, over all points of a lane's box.
 * Writes those of the results: bounds of everything that the function can give for arguments in these ranges (strings:
 * low and high are equal). It is not asked where an argument may be NaN. Results need not be rounded outwards. What is
 * bounded by it counts as declared, not as proven. */
typedef void (*AerosolRange)(const AerosolLanes* lanes, void* const* low, void* const* high);

/* A declaration is as in a shader: "float gear_distance(point p, int teeth)". A shader's structure is its fields, one
 * argument each, and an array of structures an array of each field. An array without a length ("float sum(int n, float
 * x[])") takes arrays of every length, which the function does not see: let the shader pass it beside. */
typedef struct AerosolShaderFunction {
  const char* declaration;
  AerosolEvaluate evaluate;
  AerosolRange range; /* may be null: then nothing is known of the results over boxes */
} AerosolShaderFunction;

typedef struct AerosolShaderPlugin {
  uint32_t abi;  /* AEROSOL_SHADER_ABI */
  uint32_t size; /* sizeof(AerosolShaderPlugin) */
  const char* name;
  uint32_t functionCount;
  const AerosolShaderFunction* functions;
  /* Source of a shader of the plugin's name, in which the plugin's functions are declared already; may be null. */
  const char* shader;
  /* Called once before anything else; may be null. Returns 0, or something else and a message (0-terminated) where it
   * cannot work. Not for bitcode. */
  int (*initialise)(char* message, size_t messageSize);
} AerosolShaderPlugin;

#if defined(__GNUC__)
#define AEROSOL_SHADER_EXPORT __attribute__((visibility("default")))
#else
#define AEROSOL_SHADER_EXPORT
#endif

/* Defined by the plugin: const AerosolShaderPlugin aerosol_shader_plugin = { … }; (This declaration exports it.) */
extern AEROSOL_SHADER_EXPORT const AerosolShaderPlugin aerosol_shader_plugin;

#ifdef __cplusplus
}
#endif

#endif /* AEROSOL_SHADER_H */
