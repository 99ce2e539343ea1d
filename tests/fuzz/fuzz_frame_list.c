/* Lists of frames, such as depth.txt. */
#include "drivers/recording/frame_list.h"
#include "tests/fuzz/fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct iso_frame_list list = {0};
    struct iso_fault fault = {0};
    int error = iso__frame_list_read(fuzz_file(data, size), &list, &fault);
    if (error == 0) {
        for (size_t i = 1; i < list.n; i++) {
            fuzz_check(list.entries[i - 1].t_ns < list.entries[i].t_ns, "time that rises");
        }
    } else {
        fuzz_check(fault.text[0] != '\0', "a fault that says something");
    }
    iso__frame_list_done(&list);
    return 0;
}
