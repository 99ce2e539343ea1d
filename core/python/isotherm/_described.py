"""What `isotherm-sim shapes describe` has written."""
import errno
import json
import os

import numpy as np

from ._library import Error


class Described:
    """The arrays of one mesh, by their names, and the parameters with which they were made.

    parameters: the contents of parameters.json. meaning: a line for each array, by its name.
    """

    def __init__(self, parameters, arrays):
        """For the module itself; read_described() makes them."""
        self.parameters = parameters
        self._arrays = arrays
        self.meaning = {entry['name']: entry['meaning'] for entry in parameters['arrays']}

    def __getitem__(self, name):
        """The array of a name. Raises KeyError."""
        return self._arrays[name]

    def __iter__(self):
        return iter(self._arrays)

    def __len__(self):
        return len(self._arrays)

    def __repr__(self):
        return '<isotherm.Described: %s>' % ', '.join(self._arrays)


def read_described(directory):
    """Reads a directory OUT/NAME of `isotherm-sim shapes describe`, in the format npy, csv or mat5
    (which needs SciPy). Every array must have the type and the shape that parameters.json says.
    Raises OSError for a file that cannot be read, and Error, with its name, for one that is not as
    it should be."""
    path = os.path.join(os.fsdecode(directory), 'parameters.json')
    with open(path, encoding='utf-8') as file:
        try:
            parameters = json.load(file)
            entries = [(str(a['name']), str(a['file']), np.dtype(a['type']), tuple(a['shape']), str(a['meaning']))
                       for a in parameters['arrays']]
            form = parameters['format']
        except (ValueError, KeyError, TypeError) as error:
            raise Error('%s: not written by isotherm-sim shapes describe: %r' % (path, error),
                        errno.EBADMSG) from None
    arrays = {}
    for name, file, dtype, shape, _ in entries:
        if os.path.basename(file) != file:
            raise Error('%s: the file %r is in another directory' % (path, file), errno.EBADMSG)
        arrays[name] = _read(os.path.join(os.fsdecode(directory), file), form, name, dtype, shape)
    return Described(parameters, arrays)


def _read(path, form, name, dtype, shape):
    try:
        if form == 'npy':
            array = np.load(path, allow_pickle=False)
        elif form == 'csv':
            array = np.loadtxt(path, delimiter=',', ndmin=2).astype(dtype).reshape(shape)
        elif form == 'mat5':
            import scipy.io
            array = scipy.io.loadmat(path, variable_names=[name])[name].reshape(shape)
        else:
            raise Error('%s: the format %r is unknown' % (path, form), errno.EBADMSG)
    except (ValueError, KeyError, TypeError, EOFError) as error:
        if isinstance(error, Error):
            raise
        raise Error('%s: damaged: %s' % (path, str(error).splitlines()[0] if str(error) else type(error).__name__),
                    errno.EBADMSG) from None
    if array.dtype != dtype or array.shape != shape:
        raise Error('%s: %s of the shape %s, not %s of %s' % (path, array.dtype, array.shape, dtype, shape),
                    errno.EBADMSG)
    return array
