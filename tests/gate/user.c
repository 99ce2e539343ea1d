/* A user of the installed library: nothing of this project's tree is on its include path. */
#include <isotherm/isotherm.h>

#include <stdio.h>
#include <string.h>

int main(void)
{
    const struct iso_camera camera = {.projection = ISO_PINHOLE,
                                      .width_px = 640,
                                      .height_px = 480,
                                      .fx_px = 500,
                                      .fy_px = 500,
                                      .cx_px = 320,
                                      .cy_px = 240};
    struct iso_fault fault = {.text = ""};
    if (iso_camera_check(&camera, &fault)) {
        fprintf(stderr, "camera: %s\n", fault.text);
        return 1;
    }
    struct iso_vec3 p = iso_camera_back_project(&camera, 370, 240, 1000);
    struct iso_template tmpl;
    int error = iso_template_parse("junk", 4, &tmpl);
    printf("%s at %.0f mm, junk is refused: %s\n", iso_landmark_name(ISO_LM_NOSE_TIP), p.x,
           strerror(-error));
    return p.x > 99.999 && p.x < 100.001 && error < 0 ? 0 : 1;
}
