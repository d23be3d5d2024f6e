// A study as a page, as data and as pictures.
#pragma once

#include <string>
#include <vector>

#include "core/app/study/chart.h"
#include "core/app/study/results.h"
#include "core/base/diagnostic.h"

namespace aerosol::app {

/// One row of the table, sorted by the error in equal time.
struct StudyRow {
  const StudyCase* study = nullptr;
  double error = 0;            ///< In equal time.
  double rate = 0;             ///< See convergenceRate.
  bool isWithinNoise = false;  ///< Not told from the row above by the errors of both.
};
std::vector<StudyRow> sortRows(const StudyResults& results);

/// What the study comes to, sentence by sentence: the best method, what halving its error costs, who is biased.
std::vector<std::string> conclusions(const StudyResults& results);

/// Error against time; bias and variance against time.
Chart errorChart(const StudyResults& results);
Chart partsChart(const StudyResults& results);

std::string studyJson(const StudyResults& results);
std::string studyCsv(const StudyResults& results);
/// One file that needs no other; `pictures` are PNG files as bytes: the reference, then one a case, empty where there
/// is none.
std::string studyPage(const StudyResults& results, const std::vector<std::string>& pictures);

/// Writes study.html, study.json, study.csv, error.png, parts.png and the pictures into the folder.
Diagnostics writeStudy(const StudyResults& results, const std::string& folder);

}  // namespace aerosol::app
