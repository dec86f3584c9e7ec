"""What ParaView sees of image data, as one line of JSON: python3 paraview_read.py FILE.vti..."""

import json
import sys

from paraview.servermanager import Fetch
from paraview.simple import XMLImageDataReader
from vtkmodules.util.numpy_support import vtk_to_numpy


def seen(path):
    image = Fetch(XMLImageDataReader(FileName=[path]))
    points = image.GetPointData()
    arrays = [points.GetArray(number) for number in range(points.GetNumberOfArrays())]
    return {
        "extent": image.GetExtent(),
        "origin": image.GetOrigin(),
        "spacing": image.GetSpacing(),
        "bounds": image.GetBounds(),
        "types": {array.GetName(): array.GetDataTypeAsString() for array in arrays},
        "values": {array.GetName(): vtk_to_numpy(array).tolist() for array in arrays},
    }


print(json.dumps({path: seen(path) for path in sys.argv[1:]}))
