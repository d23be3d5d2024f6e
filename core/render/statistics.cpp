#include "core/render/statistics.h"

namespace aerosol::render {

WorkerStatistics& WorkerStatistics::operator+=(const WorkerStatistics& o) {
  accel += o.accel;
  trackers.points += o.trackers.points;
  trackers.boundViolations += o.trackers.boundViolations;
  if (o.trackers.worstViolation > trackers.worstViolation) {
    trackers.worstViolation = o.trackers.worstViolation;
    trackers.worstMedium = o.trackers.worstMedium;
    trackers.worstExtinction = o.trackers.worstExtinction;
  }
  trackers.stepLimits += o.trackers.stepLimits;
  samples += o.samples;
  pathVertices += o.pathVertices;
  kernelCalls += o.kernelCalls;
  kernelPoints += o.kernelPoints;
  kernelLanes += o.kernelLanes;
  countedLanesRun += o.countedLanesRun;
  countedLanesUsed += o.countedLanesUsed;
  invalidCoefficients += o.invalidCoefficients;
  invalidClosures += o.invalidClosures;
  frameHeapBlocks += o.frameHeapBlocks;
  media.exitsWithoutEntry += o.media.exitsWithoutEntry;
  media.repeatedEntries += o.media.repeatedEntries;
  media.rejectedHits += o.media.rejectedHits;
  return *this;
}

}  // namespace aerosol::render
