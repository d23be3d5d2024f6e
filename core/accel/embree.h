// Embree 3 or 4 under the names of 3. Included by the .cpp files of this folder only.
#pragma once

#if defined(AEROSOL_EMBREE_VERSION) && AEROSOL_EMBREE_VERSION >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

namespace aerosol::accel {

// Embree 4 renamed the per-query context and moved it into an optional argument block.
#if RTC_VERSION_MAJOR >= 4

using EmbreeContext = RTCRayQueryContext;

inline void initContext(EmbreeContext& context) { rtcInitRayQueryContext(&context); }
inline void intersectRay(RTCScene scene, EmbreeContext& context, RTCRayHit& ray) {
  RTCIntersectArguments arguments;
  rtcInitIntersectArguments(&arguments);
  arguments.context = &context;
  rtcIntersect1(scene, &ray, &arguments);
}
inline void occludeRay(RTCScene scene, EmbreeContext& context, RTCRay& ray) {
  RTCOccludedArguments arguments;
  rtcInitOccludedArguments(&arguments);
  arguments.context = &context;
  rtcOccluded1(scene, &ray, &arguments);
}

#else

using EmbreeContext = RTCIntersectContext;

inline void initContext(EmbreeContext& context) { rtcInitIntersectContext(&context); }
inline void intersectRay(RTCScene scene, EmbreeContext& context, RTCRayHit& ray) {
  rtcIntersect1(scene, &context, &ray);
}
inline void occludeRay(RTCScene scene, EmbreeContext& context, RTCRay& ray) { rtcOccluded1(scene, &context, &ray); }

#endif

}  // namespace aerosol::accel
