"""Short names for the types of arrays that only the renderer uses; see also drone_engine.arrays."""

import numpy as np
from numpy.typing import NDArray

Float32s = NDArray[np.float32]
Bytes = NDArray[np.uint8]
Labels = NDArray[np.uint16]
Indices = NDArray[np.intp]
Faces = NDArray[np.int32]
