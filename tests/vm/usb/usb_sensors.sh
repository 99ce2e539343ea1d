#!/bin/sh
# The contract suite of the sensor class on USB cameras of the kernel, by V4L2 and by libcamera.
. "$VM_SOURCE/tests/vm/usb/usb_camera.sh"
insmod "$VM_CACHE/firmware_path.ko"
/lib/systemd/systemd-udevd --daemon # libcamera hears of cameras from it
export LIBCAMERA_LOG_LEVELS=*:ERROR
exec "$VM_BUILD/tests/vm/vm_sensor_contract"
