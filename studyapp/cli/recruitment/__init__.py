"""`motionjury recruit`, for every place where participants come from."""
