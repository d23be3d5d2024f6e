/* The binary interface between compiled shaders and everything else: C, no pointers into the program's image.
 *
 * A kernel is a function `void kernel(const AerosolKernelArguments*)`. It takes n points as structure of arrays and
 * loops over the SIMD width inside. Every array is 64-byte aligned and padded to a multiple of 16 elements; padding
 * lanes hold any finite value and are never reported about. Kernels hold no address: everything reaches them through
 * the arguments.
 */
#ifndef AEROSOL_ABI_H
#define AEROSOL_ABI_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { AEROSOL_ABI_VERSION = 5, AEROSOL_MAXIMUM_WIDTH = 16 };

/* Named transforms that a kernel may ask for, besides those by name through the host. Per instance, row-major 3x4
 * (rows of a map on column vectors), floats. "common" is world space. */
typedef struct AerosolInstanceHeader {
  float objectToWorld[12];
  float worldToObject[12];
  float shaderToWorld[12];
  float worldToShader[12];
} AerosolInstanceHeader;

/* The kinds of per-point records that a kernel leaves (messages and reports). */
enum {
  AEROSOL_MESSAGE_PRINT = 0,
  AEROSOL_MESSAGE_WARNING = 1,
  AEROSOL_MESSAGE_ERROR = 2,
  AEROSOL_REPORT_INDEX = 3,  /* array index out of range: two int arguments: index, length */
  AEROSOL_REPORT_BUDGET = 4, /* a loop ran out of its iteration budget: no arguments */
  AEROSOL_REPORT_HOST = 5,   /* left by a host function: `site` is that of the call, one string argument: the text */
  AEROSOL_MESSAGE_FILE = 6,  /* for the end of a file, whose name comes before the arguments of the format */
  AEROSOL_REPORT_SPACE = 7   /* a named space that there is not: one string argument: the name */
};

/* One argument of a record, 8 bytes: an int32, a float (both in the low bytes) or a string's 64-bit hash. */
typedef union AerosolRecordValue {
  int32_t i;
  float f;
  uint64_t s;
} AerosolRecordValue;

struct AerosolKernelContext;
struct AerosolKernelArguments;

/* One call of a host function for the points of one chunk. */
typedef struct AerosolHostCall {
  const struct AerosolKernelArguments* arguments; /* those of the kernel */
  /* The result where the function has one, then its arguments. Each is an array of components (of arrays: element after
   * element), each component `lanes` int32, float or (strings) uint64 in a row. What the function writes holds the old
   * values before the call; elements of lanes that are not active may not be written. */
  void* const* values;
  /* Null: a call for points. Otherwise a call for boxes of points: `values` are the least ones and these the greatest,
   * in rows of as many lanes. The function writes both ends of its results over all points of a box; NaN: nothing
   * known. */
  void* const* high;
  const int32_t* points; /* null: the lanes' points are those from `first` on; otherwise points[first + lane] */
  uint32_t site; /* index into the kernel's table of host sites: the function's name, types, constants, position */
  uint32_t first;
  uint32_t lanes;  /* 1: one set of values for all active points; otherwise the width of the kernel */
  uint32_t active; /* bit i: the point of lane i makes the call */
} AerosolHostCall;

/* Host services. `context` is the pointer of the arguments. All are thread-safe for distinct contexts. */
typedef struct AerosolHostServices {
  uint32_t size; /* sizeof(AerosolHostServices) */
  /* Leaves one record. `site` indexes the kernel's table of message sites (format string, position, argument types);
   * `lane` is the point's index in the batch; `sequence` is set by the callee in call order. */
  void (*record)(struct AerosolKernelContext* context, uint32_t kind, uint32_t site, uint32_t lane,
                 const AerosolRecordValue* arguments, uint32_t count);
  /* Matrix of a named space for one point: writes 16 floats (row-major, rows of a map on column vectors; projections
   * too), returns 1 when the name is known. */
  int32_t (*spaceToWorld)(struct AerosolKernelContext* context, uint64_t name, uint32_t instance, float time,
                          float* matrix);
  int32_t (*worldToSpace)(struct AerosolKernelContext* context, uint64_t name, uint32_t instance, float time,
                          float* matrix);
  /* Calls a host function. */
  void (*call)(struct AerosolKernelContext* context, const AerosolHostCall* call);
} AerosolHostServices;

/* Counts kept by kernels that were compiled with counters. */
typedef struct AerosolKernelCounters {
  uint64_t lanesRun;  /* weighted by the static cost of each block */
  uint64_t lanesUsed; /* the part of lanesRun whose mask was set */
} AerosolKernelCounters;

/* What the host keeps for one thread; kernels see only this head. */
typedef struct AerosolKernelContext {
  const AerosolHostServices* services;
  AerosolKernelCounters counters;
  uint32_t loopBudget; /* iterations of one loop statement that one point may run in one call */
} AerosolKernelContext;

typedef struct AerosolKernelArguments {
  AerosolKernelContext* context;
  /* One pointer a component of each global that the kernel reads, in the order of Global, components x y z. Where the
   * kernel's interface says that a global is not read, its pointers may be null. Layout: P.x P.y P.z I.x I.y I.z N.x
   * N.y N.z Ng.x Ng.y Ng.z u v dPdu.xyz dPdv.xyz Ps.xyz time dtime dPdtime.xyz (28 pointers), then
   *   dPdx.xyz dPdy.xyz dPdz.xyz dIdx.xyz dIdy.xyz dudx dudy dvdx dvdy dPsdx.xyz dPsdy.xyz flipHandedness
   * (26 more): the derivatives that Dx, Dy, Dz, filterwidth, area, calculatenormal and filtered lookups start from. x
   * and y are the host's two directions between neighbouring shading samples (of a picture: one pixel; of a grid of n x
   * m points over the unit square: dudx = 1/n, dvdy = 1/m), z is the step in depth of volume shading. A host without
   * neighbours gives zeros. They are read only where the shader uses a derivative. N, Ng, dPdu, dPdv, time, dtime and
   * dPdtime have no derivatives. flipHandedness is 0, or 1 where calculatenormal has to point the other way. */
  const float* const* globals;
  const int32_t* instances; /* per point: index of its instance; may be null when the kernel does not read instances */
  const uint32_t* active;   /* per point: all bits set or zero; null: all n points are active */
  /* Instance i's block starts at instanceData + i * stride, stride as in the kernel's interface: an
   * AerosolInstanceHeader, then the parameters that were not folded. */
  const unsigned char* instanceData;
  /* One pointer a component of each output of the variant, in the order of the kernel's interface. Inactive points'
   * elements are not written. Int outputs are stored as int32 bits, strings as uint64 arrays. */
  void* const* outputs;
  int32_t count;
} AerosolKernelArguments;

typedef void (*AerosolKernel)(const AerosolKernelArguments*);

#ifdef __cplusplus
}
#endif

#endif /* AEROSOL_ABI_H */
