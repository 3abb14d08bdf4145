// The commands of the program that belong to the thesis; each adds itself.
#pragma once

#include "app/app.h"

namespace dynoproof::app {

void AddCoupling(Command program);
void AddReproduce(Command program);

}  // namespace dynoproof::app
