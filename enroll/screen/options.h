/* The command line of isotherm-screen. */
#ifndef ENROLL_SCREEN_OPTIONS_H
#define ENROLL_SCREEN_OPTIONS_H

#include <stdbool.h>

struct screen_options {
    const char *bus;      /* "system", "session" or an address */
    const char *language; /* of screen_languages */
    const char *place;    /* the name of the place; "" */
    const char *catalogues;
    const char *device;      /* of the graphics card; "": the first with a monitor */
    const char *png;         /* a directory for pictures instead of a monitor; "" */
    bool window;             /* a window instead of a monitor */
    bool speak;              /* say aloud what is shown */
    int width_px, height_px; /* of the pictures or the window */
    int rotate;              /* 0, 90, 180, 270 degrees clockwise */
    const char *fingerprint; /* the file of the web server's fingerprint; "": none */
    const char *setup_code;  /* the file of the code for its first account; "": none */
    bool verbose;            /* print what is shown, but no names */
    bool show_names;
    int seconds; /* end after this time; 0: never */
};

/* Reads the command line. Returns 0; 1 if help or version was printed; or -EINVAL after a line on
 * stderr that says what is wrong. */
int screen_options_read(int argc, char **argv, struct screen_options *out)
    __attribute__((warn_unused_result));

#endif
