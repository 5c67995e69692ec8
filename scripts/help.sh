# Taken in by the scripts beside it: on --help the comment at their head is printed, and nothing else is done.
case ${1-} in -h | --help) sed -n '2,/^set /{/^set /d;s/^# \{0,1\}//;p}' "$0"; exit ;; esac
