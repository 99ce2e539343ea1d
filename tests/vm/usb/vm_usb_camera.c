/* vm_usb_camera BENCH [--intensity]: puts a USB camera on a bench, prints its video nodes, and
 * keeps it there until SIGTERM. SIGUSR1 makes its transfers fail until streams are started again.
 */
#include <signal.h>
#include <stdio.h>
#include <string.h>

#include "tests/vm/usb/usb_bench.h"

int main(int argc, char **argv)
{
    const bool intensity = argc == 3 && strcmp(argv[2], "--intensity") == 0;
    struct usb_bench *bench = NULL;
    struct iso_fault fault = {.text = ""};
    sigset_t signals;
    int number = 0;
    if (argc != 2 && !intensity) {
        fprintf(stderr, "usage: %s BENCH [--intensity]\n", argv[0]);
        return 2;
    }
    (void)sigemptyset(&signals);
    (void)sigaddset(&signals, SIGTERM);
    (void)sigaddset(&signals, SIGUSR1);
    (void)sigprocmask(SIG_BLOCK, &signals, NULL);
    if (usb_bench_new(argv[1], intensity, &bench, &fault)) {
        fprintf(stderr, "%s\n", fault.text);
        return 4;
    }
    for (int i = 0; i < 1 + intensity; i++) {
        puts(usb_bench_node(bench, i));
    }
    (void)fflush(stdout);
    while (sigwait(&signals, &number) == 0 && number == SIGUSR1) {
        usb_bench_halt(bench);
    }
    usb_bench_free(bench);
    return 0;
}
