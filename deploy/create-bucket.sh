#!/bin/sh
# Creates the bucket unless it exists. `weed shell` exits with 0 even after an error, so the list of buckets decides.
set -eu
: "${BUCKET:?is not set}" "${MASTER:=objects:9333}"
weed_shell() {
	echo "$1" | weed shell -master="$MASTER"
}
for attempt in 1 2 3 4 5 6; do
	weed_shell "s3.bucket.create -name $BUCKET" || true
	if weed_shell s3.bucket.list | grep -qw "$BUCKET"; then
		exit 0
	fi
	echo "bucket $BUCKET does not exist after attempt $attempt" >&2
	sleep "${PAUSE_S:-5}"
done
exit 1
