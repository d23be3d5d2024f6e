// The options of aerosol bake.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "core/app/arguments.h"

namespace aerosol::app {

void addBake(CLI::App& program, BakeArguments& bake);

/// What is wrong with options together; empty when that is nothing.
std::string problemOf(const BakeArguments& bake);

}  // namespace aerosol::app
