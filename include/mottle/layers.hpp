// Which layers' names each layer sees: those of the layers below it, as tools/layers.txt has them. A layer's namespace
// is mottle::<layer>, of core mottle itself.
#pragma once

namespace mottle {

namespace linalg {}
namespace stats {
using namespace linalg;
}
namespace dynamics {
using namespace linalg;
}
namespace fem {
using namespace linalg;
}
namespace formats {
using namespace dynamics;
using namespace fem;
}  // namespace formats
namespace model {
using namespace dynamics;
using namespace stats;
using namespace fem;
using namespace formats;
}  // namespace model
namespace drivers {
using namespace model;
}
namespace updating {
using namespace model;
}
namespace study {
using namespace updating;
using namespace drivers;
}  // namespace study
namespace report {
using namespace study;
}
namespace app {
using namespace report;
}

}  // namespace mottle
