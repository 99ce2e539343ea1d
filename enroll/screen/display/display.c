#include "enroll/screen/display/display.h"

#include <stddef.h>

void screen_display_close(struct screen_display *display)
{
    if (display->ops) {
        display->ops->close(display->self);
    }
    *display = (struct screen_display){.ops = NULL};
}
