"""Pictures of functions on meshes, if matplotlib is there (Debian: python3-matplotlib)."""


def draw(path, panels):
    """Draws meshes beside each other into a PNG file. panels: a list of (title, vertices, triangles,
    function of the vertices)."""
    try:
        import matplotlib
    except ImportError:
        print('no picture: matplotlib is not installed (python3-matplotlib)')
        return
    matplotlib.use('Agg')  # draws into files and needs no screen
    from matplotlib import pyplot
    figure = pyplot.figure(figsize=(4 * len(panels), 4))
    for i, (title, vertices, triangles, function) in enumerate(panels):
        axes = figure.add_subplot(1, len(panels), i + 1, projection='3d')
        axes.set_box_aspect(vertices.max(axis=0) - vertices.min(axis=0))
        # With antialiasing the back of the surface would show through between the triangles.
        surface = axes.plot_trisurf(*vertices.T, triangles=triangles, cmap='inferno', linewidth=0, antialiased=False)
        surface.set_array(function[triangles].mean(axis=1))  # a colour for each triangle
        surface.autoscale()
        axes.set_title(title)
        axes.set_axis_off()
    figure.savefig(path, dpi=100)
    pyplot.close(figure)
    print('picture: %s' % path)
