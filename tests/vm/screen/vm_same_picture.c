/* usage: vm_same_picture FILE.png FILE.ppm
 * Ends with 0 if both pictures have the same size and the same pixels; prints how many differ. */
#include <cairo.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Reads a binary PPM of 8 bits a channel. Returns its bytes, which the caller frees, or NULL. */
static unsigned char *read_ppm(const char *path, int *width, int *height)
{
    FILE *file = fopen(path, "rb");
    unsigned char *bytes = NULL;
    if (file && fscanf(file, "P6 %d %d 255", width, height) == 2 && fgetc(file) != EOF &&
        *width > 0 && *height > 0 && *width <= 4096 && *height <= 4096) {
        const size_t size = (size_t)3 * (size_t)*width * (size_t)*height;
        bytes = malloc(size);
        if (bytes && fread(bytes, 1, size, file) != size) {
            free(bytes);
            bytes = NULL;
        }
    }
    if (file) {
        (void)fclose(file);
    }
    return bytes;
}

static long count_differences(cairo_surface_t *png, const unsigned char *ppm, int width, int height)
{
    const unsigned char *data = cairo_image_surface_get_data(png);
    const int stride = cairo_image_surface_get_stride(png);
    long n = 0;
    for (int y = 0; y < height; y++) {
        for (int x = 0; x < width; x++) {
            const unsigned char *seen = ppm + 3 * ((size_t)y * (size_t)width + (size_t)x);
            uint32_t wanted;
            memcpy(&wanted, data + (size_t)y * (size_t)stride + (size_t)4 * (size_t)x,
                   sizeof wanted);
            n += (wanted & 0xffffff) != (uint32_t)(seen[0] << 16 | seen[1] << 8 | seen[2]);
        }
    }
    return n;
}

int main(int argc, char **argv)
{
    int width = 0;
    int height = 0;
    unsigned char *ppm = argc == 3 ? read_ppm(argv[2], &width, &height) : NULL;
    cairo_surface_t *png = argc == 3 ? cairo_image_surface_create_from_png(argv[1]) : NULL;
    int result = EXIT_FAILURE;
    if (!ppm || cairo_surface_status(png) != CAIRO_STATUS_SUCCESS) {
        fputs("vm_same_picture: a picture cannot be read\n", stderr);
    } else if (cairo_image_surface_get_width(png) != width ||
               cairo_image_surface_get_height(png) != height) {
        printf("the sizes differ: %d x %d and %d x %d\n", cairo_image_surface_get_width(png),
               cairo_image_surface_get_height(png), width, height);
    } else {
        const long n = count_differences(png, ppm, width, height);
        printf("%ld of %d pixels differ\n", n, width * height);
        result = n == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
    }
    cairo_surface_destroy(png);
    free(ppm);
    return result;
}
