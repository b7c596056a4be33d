"""Short names for the types of arrays."""

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Float32s = NDArray[np.float32]  # of pictures
Integers = NDArray[np.int64]
Int32s = NDArray[np.int32]  # of pictures
Booleans = NDArray[np.bool_]
