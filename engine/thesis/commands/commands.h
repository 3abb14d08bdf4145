// The commands of the program that belong to the thesis; each adds itself, `exit` is set by the one that runs.
#pragma once

#include "app/app.h"

namespace dynoproof::app {

void AddCoupling(CLI::App& program, int& exit);
void AddReproduce(CLI::App& program, int& exit);

}  // namespace dynoproof::app
