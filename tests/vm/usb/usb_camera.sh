# For scripts of tests with USB cameras: `. "$VM_SOURCE/tests/vm/usb/usb_camera.sh"` loads the modules. For programs, see usb_camera.h.
set -eu
modprobe -d "$VM_CACHE/root" vhci-hcd
modprobe -d "$VM_CACHE/root" uvcvideo
