/* A window on a desktop (Wayland or X11), by SDL. The program loads the library only
 * with the option --window: on the monitor of a door it would need memory for nothing. */
#include <SDL2/SDL.h>
#include <dlfcn.h>
#include <errno.h>
#include <signal.h>
#include <stdlib.h>
#include <unistd.h>

#include "enroll/screen/display/display.h"

static const char library_name[] = "libSDL2-2.0.so.0";

/* The functions of the library that are used, with the types of its header. */
#define FUNCTIONS(USE)            \
    USE(SDL_SetHint)              \
    USE(SDL_Init)                 \
    USE(SDL_GetError)             \
    USE(SDL_CreateWindow)         \
    USE(SDL_DestroyWindow)        \
    USE(SDL_GetWindowSurface)     \
    USE(SDL_UpdateWindowSurface)  \
    USE(SDL_CreateRGBSurfaceFrom) \
    USE(SDL_UpperBlit)            \
    USE(SDL_FreeSurface)          \
    USE(SDL_PollEvent)

#define MEMBER(name) __typeof__(name) *name;
struct sdl {
    FUNCTIONS(MEMBER)
};

struct window {
    void *library;
    struct sdl sdl;
    SDL_Window *window;
    cairo_surface_t *surface; /* of the size of the window; NULL: it has to be made */
};

static int load(struct window *window, struct iso_fault *fault)
{
    window->library = dlopen(library_name, RTLD_NOW | RTLD_LOCAL);
    if (!window->library) {
        return iso_fault_set(fault, -ENOENT, "a window needs %s of the package libsdl2-2.0-0: %s",
                             library_name, dlerror());
    }
    /* POSIX lets a pointer to a function be read as a pointer to an object. */
#define LOAD(name) *(void **)(&window->sdl.name) = dlsym(window->library, #name);
    FUNCTIONS(LOAD)
#define IS_MISSING(name) || !window->sdl.name
    if (false FUNCTIONS(IS_MISSING)) {
        return iso_fault_set(fault, -ENOENT, "%s is too old for a window", library_name);
    }
    return 0;
}

static int open_window(struct window *window, int width_px, int height_px, struct iso_fault *fault)
{
    const struct sdl *sdl = &window->sdl;
    /* The program's own event loop receives SIGTERM and SIGINT. A window must not keep a desktop
     * from going to sleep. */
    (void)sdl->SDL_SetHint(SDL_HINT_NO_SIGNAL_HANDLERS, "1");
    (void)sdl->SDL_SetHint(SDL_HINT_VIDEO_ALLOW_SCREENSAVER, "1");
    if (sdl->SDL_Init(SDL_INIT_VIDEO)) {
        return iso_fault_set(fault, -ENODEV, "there is no desktop for a window: %s",
                             sdl->SDL_GetError());
    }
    window->window = sdl->SDL_CreateWindow("Isotherm", SDL_WINDOWPOS_UNDEFINED,
                                           SDL_WINDOWPOS_UNDEFINED, width_px, height_px,
                                           SDL_WINDOW_RESIZABLE);
    if (!window->window) {
        return iso_fault_set(fault, -ENODEV, "there is no window: %s", sdl->SDL_GetError());
    }
    return 0;
}

static cairo_surface_t *begin(void *self)
{
    struct window *window = self;
    if (!window->surface) {
        const SDL_Surface *whole = window->sdl.SDL_GetWindowSurface(window->window);
        if (!whole || whole->w < 16 || whole->h < 16) {
            return NULL;
        }
        window->surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, whole->w, whole->h);
        if (cairo_surface_status(window->surface) != CAIRO_STATUS_SUCCESS) {
            cairo_surface_destroy(window->surface);
            window->surface = NULL;
        }
    }
    return window->surface;
}

static int show(void *self)
{
    struct window *window = self;
    const struct sdl *sdl = &window->sdl;
    cairo_surface_t *from = window->surface;
    cairo_surface_flush(from);
    SDL_Surface *picture = sdl->SDL_CreateRGBSurfaceFrom(
        cairo_image_surface_get_data(from), cairo_image_surface_get_width(from),
        cairo_image_surface_get_height(from), 32, cairo_image_surface_get_stride(from), 0xff0000,
        0xff00, 0xff, 0);
    SDL_Surface *whole = sdl->SDL_GetWindowSurface(window->window);
    const bool shown = picture && whole && sdl->SDL_UpperBlit(picture, NULL, whole, NULL) == 0 &&
                       sdl->SDL_UpdateWindowSurface(window->window) == 0;
    if (picture) {
        sdl->SDL_FreeSurface(picture);
    }
    return shown ? 0 : -EIO;
}

/* A window that is closed ends the program in the same way as SIGTERM. */
static bool look(void *self)
{
    struct window *window = self;
    SDL_Event event;
    bool anew = false;
    while (window->sdl.SDL_PollEvent(&event)) {
        if (event.type == SDL_QUIT) {
            (void)kill(getpid(), SIGTERM);
        } else if (event.type == SDL_WINDOWEVENT &&
                   event.window.event == SDL_WINDOWEVENT_SIZE_CHANGED) {
            cairo_surface_destroy(window->surface);
            window->surface = NULL;
            anew = true;
        } else if (event.type == SDL_WINDOWEVENT && event.window.event == SDL_WINDOWEVENT_EXPOSED) {
            anew = true;
        }
    }
    return anew;
}

/* The library and the connection to the desktop stay until the process ends, which follows at once.
 */
static void close_window(void *self)
{
    struct window *window = self;
    cairo_surface_destroy(window->surface);
    if (window->window) {
        window->sdl.SDL_DestroyWindow(window->window);
    }
    free(window);
}

static const struct screen_display_ops ops = {begin, show, look, close_window, .looks_often = true};

int screen_display_window(int width_px, int height_px, struct screen_display *out,
                          struct iso_fault *fault)
{
    struct window *window = calloc(1, sizeof *window);
    if (!window) {
        return iso_fault_set(fault, -ENOMEM, "out of memory");
    }
    int error = load(window, fault);
    error = error ? error : open_window(window, width_px, height_px, fault);
    if (error) {
        close_window(window);
        return error;
    }
    *out = (struct screen_display){&ops, window};
    return 0;
}
